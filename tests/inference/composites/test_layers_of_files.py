"""Layers: each has a map of its own, and goes back to its place in a file of the same kind."""

import io
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normalgan.__main__ import main
from normalgan.decoding import DecodedLayer, DecodedLayers
from normalgan.errors import InputError
from normalgan.inference.composites import layered_job
from normalgan.inference.composites.layers import encode_layers, layered_kind, picture_of, read_layers
from pens import blob, outline

Pixels = NDArray[np.uint8]
SHAPE = (80, 120)
KINDS = ("psd", "ora", "aseprite")
FILES = Path(__file__).parent / "layered"
"""A picture of three layers and a hidden one, saved by Krita 5.1: paper, a body, an arm in a faded group."""


def drawn(centre: tuple[int, int], radius: int) -> Pixels:
    """Return a disc with a dark rim, transparent about it."""
    filled = blob(SHAPE, centre, radius)
    shade = np.rint(255 * (1 - 0.9 * outline(filled)))
    return np.dstack([shade, shade, shade, 255 * (filled > 0.5)]).astype(np.uint8)


def layer(name: str, pixels: Pixels, number: int, groups: tuple[str, ...] = (), **other: int) -> DecodedLayer:
    rows, columns = np.flatnonzero(pixels[..., 3].any(1)), np.flatnonzero(pixels[..., 3].any(0))
    box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    opacity, frame = other.get("opacity", 255), other.get("frame", 0)
    return DecodedLayer(name, groups, opacity, int(columns[0]), int(rows[0]), number, frame, pixels[box])


PAPER = np.full((*SHAPE, 4), 255, np.uint8)
PAPER_LAYER = layer("paper", PAPER, 0)
STACK = [
    PAPER_LAYER,
    layer("body", drawn((50, 44), 26), 1),
    layer("hand", drawn((90, 30), 14), 2, ("limbs", "arm"), opacity=102),
    layer("hat", drawn((50, 16), 12), 3),
]


def generate(*arguments: str) -> int:
    return main(["generate", *arguments, "--model", "model.onnx"])


def same(one: DecodedLayer, other: DecodedLayer) -> bool:
    places = [(each.name, each.groups, each.left, each.top, each.frame) for each in (one, other)]
    return places[0] == places[1] and np.array_equal(one.pixels, other.pixels)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_is_what_is_read(kind: str) -> None:
    content = encode_layers(kind, SHAPE, STACK)  # type: ignore[arg-type]
    found = read_layers(Path("a"), content)
    assert found.shape == SHAPE
    assert [each.opacity for each in found.layers] == [255, 255, 102, 255]
    assert all(same(one, other) for one, other in zip(found.layers, STACK, strict=True))


@pytest.mark.parametrize("name", ["krita.kra", "krita.psd"])
def test_files_that_krita_saved_are_read(name: str) -> None:
    found = read_layers(FILES / name)
    assert found.shape == (150, 200)
    assert [(each.groups, each.name, each.left, each.top) for each in found.layers] == [
        ((), "paper", 0, 0),
        ((), "body", 20, 40),
        (("limbs",), "arm & hand", 105, 25),
    ]
    assert [each.pixels.shape for each in found.layers] == [(150, 200, 4), (101, 161, 4), (26, 46, 4)]
    assert found.layers[2].opacity == pytest.approx(255 * 0.5 * 0.8, abs=1)
    arm = found.layers[2].pixels
    assert arm[13, 20].tolist() == [60, 120, 200, 255]
    assert arm[0, 0].tolist() == [0, 0, 0, 255]


@pytest.mark.parametrize("kind", KINDS)
def test_a_layer_that_is_seen_alone_is_predicted_as_a_drawing_of_its_own(
    here: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layered_job, "surest", lambda ways, infer: (ways[0], *infer(ways[0])))
    Path(f"fox.{kind}").write_bytes(encode_layers(kind, SHAPE, STACK))  # type: ignore[arg-type]
    assert generate(f"fox.{kind}", "--layers") == 0
    assert [each.name for each in Path("normals").iterdir()] == [f"fox_normal.{kind}"]
    found = read_layers(Path(f"normals/fox_normal.{kind}"))
    assert [(each.name, each.groups, each.opacity) for each in found.layers] == [
        ("body", (), 255),
        ("hand", ("limbs", "arm"), 102),
        ("hat", (), 255),
    ]
    for predicted, given in zip(found.layers, STACK[1:], strict=True):
        picture = picture_of(given, SHAPE)
        assert picture.alpha is not None
        alone = np.dstack([picture.colour, picture.alpha])
        Image.fromarray(np.rint(255 * alone).astype(np.uint8)).save(f"{given.name}.png")
        assert generate(f"{given.name}.png", "--alpha", "--pad", "0") == 0
        expected = np.asarray(Image.open(f"normals/{given.name}_normal.png"))
        rows, columns = predicted.pixels.shape[:2]
        inside = np.s_[predicted.top : predicted.top + rows, predicted.left : predicted.left + columns]
        assert np.array_equal(predicted.pixels, expected[inside])
        assert not np.delete(expected[..., 3], np.arange(inside[0].start, inside[0].stop), 0).any()


@pytest.mark.slow
def test_a_body_is_seen_with_its_head_and_the_head_alone(here: Path) -> None:
    body, head = (np.zeros((320, 320, 4), np.uint8) for _ in range(2))
    for pixels, middle, axes in ((body, (144, 176), (104, 56)), (head, (240, 120), (40, 32))):
        cv2.ellipse(pixels, middle, axes, 0, 0, 360, (255, 255, 255, 255), -1)
        cv2.ellipse(pixels, middle, axes, 0, 0, 360, (0, 0, 0, 255), 3)
    stack = [layer("body", body, 0), layer("head", head, 1)]
    Path("fox.ora").write_bytes(encode_layers("ora", (320, 320), stack))
    assert main(["generate", "fox.ora", "--layers"]) == 0
    together = read_layers(Path("normals/fox_normal.ora")).layers
    for each in stack:
        Path(f"{each.name}.ora").write_bytes(encode_layers("ora", (320, 320), [each]))
        assert main(["generate", f"{each.name}.ora", "--layers"]) == 0
    alone = [read_layers(Path(f"normals/{each.name}_normal.ora")).layers[0] for each in stack]
    as_alone = [
        same(one, replace(other, number=one.number)) for one, other in zip(together, alone, strict=True)
    ]
    assert as_alone == [False, True]


def test_of_a_krita_file_an_openraster_file_is_made(here: Path) -> None:
    assert generate(str(FILES / "krita.kra"), "--layers", "--size", "100") == 0
    written = Path("normals/krita_normal.ora")
    found = read_layers(written)
    assert found.shape == (75, 100)
    assert [each.name for each in found.layers] == ["body", "arm & hand"]
    with zipfile.ZipFile(written) as file:
        assert file.infolist()[0].filename == "mimetype"
        assert file.read("mimetype") == b"image/openraster"
        assert Image.open(io.BytesIO(file.read("mergedimage.png"))).size == (100, 75)
        assert Image.open(io.BytesIO(file.read("Thumbnails/thumbnail.png"))).size == (100, 75)


def test_what_a_layered_file_cannot_hold_is_written_one_a_layer(here: Path) -> None:
    Path("fox.psd").write_bytes(encode_layers("psd", SHAPE, STACK))
    assert generate("fox.psd", "--layers", "--bits", "16", "--height", "png", "--alpha") == 0
    assert sorted(each.name for each in Path("normals").iterdir()) == [
        *("fox_02_body_height.png", "fox_02_body_normal.png"),
        *("fox_03_limbs_arm_hand_height.png", "fox_03_limbs_arm_hand_normal.png"),
        *("fox_04_hat_height.png", "fox_04_hat_normal.png"),
    ]
    assert generate("fox.psd", "--layers", "--engine", "unity", "-o", "unity") == 0
    assert len(list(Path("unity").glob("*_NormalMap.png.meta"))) == 3
    assert generate("fox.psd", "--layers", "--bits", "16", "--skip-existing") == 0


def test_each_layers_file_is_named_and_missed(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("fox.psd").write_bytes(encode_layers("psd", SHAPE, STACK))
    names = [
        Path(f"normals/fox_{layer}_{kind}.png")
        for layer in ("02_body", "03_limbs_arm_hand", "04_hat")
        for kind in ("normal", "height")
    ]
    arguments = "fox.psd", "--layers", "--bits", "16", "--height", "png"
    assert generate(*arguments, "--dry-run") == 0
    assert capsys.readouterr().out == f"fox.psd -> {', '.join(map(str, names))}\n"
    assert generate(*arguments) == 0
    for lost in names:
        lost.unlink()
        assert generate(*arguments, "--skip-existing") == 0
        assert lost.exists()


def test_layers_of_an_animation_move(here: Path) -> None:
    moving = [
        layer("body", drawn((50, 44), 26), 0, frame=0),
        layer("ball", drawn((90, 20), 12), 1, frame=0),
        layer("body", drawn((50, 44), 26), 0, frame=1, opacity=128),
        layer("ball", drawn((90, 60), 12), 1, frame=1),
    ]
    Path("walk.ase").write_bytes(encode_layers("aseprite", SHAPE, moving, [80, 120]))
    assert generate("walk.ase", "--layers") == 0
    found = read_layers(Path("normals/walk_normal.aseprite"))
    assert found.durations == [80, 120]
    assert [(each.name, each.frame, each.opacity) for each in found.layers] == [
        *(("body", 0, 255), ("ball", 0, 255), ("body", 1, 128), ("ball", 1, 255))
    ]
    still = [each.pixels for each in found.layers if each.name == "body"]
    assert np.array_equal(still[0], still[1])
    assert generate("walk.ase", "--layers", "--bits", "16", "-o", "each") == 0
    assert sorted(each.name for each in Path("each").iterdir())[0] == "walk_01_body_0001_normal.png"


def test_layers_that_nothing_can_be_seen_on_are_left_out_and_named(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mist = np.full((*SHAPE, 4), 255, np.uint8)
    mist[:, 60:] = 253
    Path("fox.ora").write_bytes(encode_layers("ora", SHAPE, [layer("mist", mist, 0), *STACK[1:]]))
    assert generate("fox.ora", "--layers") == 1
    found = read_layers(Path("normals/fox_normal.ora")).layers
    assert [each.name for each in found] == ["body", "hand", "hat"]
    said = capsys.readouterr().err
    assert "layer 'mist': it is left out, because no lines were found in it" in said
    assert "some frames or layers of 1 of 1 sketches could not be used" in said


def test_a_speck_is_a_drawing_too(here: Path) -> None:
    speck = np.zeros((*SHAPE, 4), np.uint8)
    speck[4:6, 4:6] = 255
    Image.fromarray(speck).save("speck.png")  # the square that the model is shown is ink all over
    assert generate("speck.png") == 0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["flat.png"],
            "flat.png has no layers; those of .psd, .kra, .ora, .ase and .aseprite can be predicted",
        ),
        (["flat.png", "--bits", "16"], "flat.png has no layers"),
        (["paper.ora"], "none of its layers holds a drawing"),
        (["fox.ora", "-o", "fox.png"], "fox.png holds one map; --layers needs a folder (-o)"),
        (["fox.ora", "-o", ".", "--suffix", ""], "fox.ora is an input and would be overwritten"),
        (
            ["fox.ora", "--mask", "flat.png"],
            "fox.ora is predicted layer by layer; a mask or hints belong to one",
        ),
        (["fox.ora", "--sheet", "2x1"], "--layers predicts each layer as a whole"),
    ],
)
def test_what_cannot_be_done_is_told(
    here: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    Path("fox.ora").write_bytes(encode_layers("ora", SHAPE, STACK))
    Path("paper.ora").write_bytes(encode_layers("ora", SHAPE, STACK[:1]))
    Image.fromarray(drawn((50, 44), 26)).save("flat.png")
    before = Path("fox.ora").read_bytes()
    assert generate(*arguments, "--layers") == 2
    assert sentence in capsys.readouterr().err
    assert Path("fox.ora").read_bytes() == before


def krita(change: bytes, to: bytes) -> bytes:
    """Return Krita's file with something else in its description."""
    out = io.BytesIO()
    with zipfile.ZipFile(FILES / "krita.kra") as old, zipfile.ZipFile(out, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            new.writestr(name, content.replace(change, to) if name.endswith((".xml", "layer5")) else content)
    return out.getvalue()


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (krita(b'nodetype="paintlayer"', b'nodetype="shapelayer"'), "'paper': vector layer left out"),
        (krita(b'"RGBA" compositeop', b'"CMYKA" compositeop'), "its colours are CMYKA"),
        (krita(b"<layers>", b"<layers"), "has a broken maindoc.xml"),
        (krita(b'visible="1"', b'visible="0"'), "has no visible layer with content"),
        (encode_layers("psd", SHAPE, STACK)[:900], "has layers that cannot be read"),
    ],
)
def test_layers_that_cannot_be_read_are_told_in_a_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        read_layers(Path("a.any"), content)
    assert sentence in str(caught.value)


def test_kinds_are_told_by_what_is_in_a_file(tmp_path: Path) -> None:
    for kind in KINDS:
        assert layered_kind(Path("stdin"), encode_layers(kind, SHAPE, STACK)) == kind  # type: ignore[arg-type]
    assert layered_kind(FILES / "krita.kra") == "ora"
    assert layered_kind(tmp_path / "none.psd") is None


def test_a_layer_that_is_broken_does_not_cost_the_others() -> None:
    found = read_layers(Path("a.kra"), krita(b"LZF", b"LZ4"))
    assert "cannot be read: a tile has an unknown compression" in found.notes.text
    assert len(found.layers) == 2


def broken(kind: str) -> bytes:
    """Return a layered file whose lowest layer has broken pixels."""
    if kind == "kra":
        return krita(b"LZF", b"LZ4")
    content = encode_layers(kind, SHAPE, STACK[1:])  # type: ignore[arg-type]
    if kind == "aseprite":
        at = content.index(b"x\x9c") + 2
        return content[:at] + bytes(4) + content[at + 4 :]
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(out, "w") as new:
        for name in old.namelist():
            new.writestr(name, b"no picture" if name.endswith("layer000.png") else old.read(name))
    return out.getvalue()


@pytest.mark.parametrize("kind", ["kra", "ora", "aseprite"])
def test_where_a_layer_is_missing_the_rest_is_written_and_the_exit_code_is_1(
    here: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    Path(f"fox.{kind}").write_bytes(broken(kind))
    assert generate(f"fox.{kind}", "--layers") == 1
    said = capsys.readouterr().err
    assert "cannot be read" in said
    assert "some frames or layers of 1 of 1 sketches could not be used" in said
    written = Path(f"normals/fox_normal.{'ora' if kind == 'kra' else kind}")
    # Krita's file has a sheet of paper besides, which is not written.
    assert len(read_layers(written).layers) == (1 if kind == "kra" else 2)
    if kind == "aseprite":
        assert generate(f"fox.{kind}", "-o", "whole") == 1
        assert "cannot be read" in capsys.readouterr().err
        assert Path("whole/fox_normal.png").is_file()


def test_what_is_only_shown_otherwise_does_not_count_as_missing(here: Path) -> None:
    Path("fox.psd").write_bytes(encode_layers("psd", SHAPE, STACK))
    assert generate("fox.psd", "--layers") == 0


@pytest.mark.parametrize("kind", KINDS)
def test_names_of_every_script_are_kept(kind: str) -> None:
    names = [
        "\u30ec\u30a4\u30e4\u30fc 1",
        "\u0421\u043b\u043e\u0439",
        "\U0001f98a",
        "K\u00f6rper",
        "\u5f35" * 255,
    ]
    stack = [layer(each, drawn((50, 44), 26), i, (each,)) for i, each in enumerate(names)]
    found = read_layers(Path("a"), encode_layers(kind, SHAPE, stack))  # type: ignore[arg-type]
    assert [(each.name, each.groups) for each in found.layers] == [(each, (each,)) for each in names]


def test_a_name_that_xml_cannot_hold_is_replaced() -> None:
    content = encode_layers("ora", SHAPE, [layer("a\1b", drawn((50, 44), 26), 0)])
    assert read_layers(Path("a"), content).layers[0].name == "a\ufffdb"


def photoshop(change: Callable[[Any, Any, Any], None]) -> DecodedLayers:
    """A PSD of a body and a shade above it, after a change."""
    from psd_tools import PSDImage

    psd: Any = PSDImage.frompil(Image.new("RGBA", SHAPE[::-1]))
    body = psd.create_pixel_layer(Image.fromarray(drawn((50, 44), 20)), name="body")
    shade = psd.create_pixel_layer(Image.fromarray(drawn((70, 44), 20)), name="shade")
    change(psd, body, shade)
    out = io.BytesIO()
    psd.save(out)
    return read_layers(Path("a.psd"), out.getvalue())


def test_clipped_layers_of_photoshop_are_cut_by_their_base_and_stay_clipped() -> None:
    def clip(psd: Any, body: Any, shade: Any) -> None:
        shade.clipping = True

    found = photoshop(clip)
    base, cut = found.layers
    assert (cut.name, cut.clipped_to) == ("shade", base.number)
    assert cut.left + cut.pixels.shape[1] == base.left + base.pixels.shape[1]
    again = read_layers(Path("a.psd"), encode_layers("psd", SHAPE, found.layers))
    assert [each.clipped_to for each in again.layers] == [-1, base.number]
    # Without its base it stands alone.
    alone = read_layers(Path("a.psd"), encode_layers("psd", SHAPE, [layer("paper", PAPER, 7), cut]))
    assert [each.clipped_to for each in alone.layers] == [-1, -1]

    def hide(psd: Any, body: Any, shade: Any) -> None:
        clip(psd, body, shade)
        body.visible = False

    with pytest.raises(InputError, match="has no visible layer"):
        photoshop(hide)


def test_fill_opacity_and_blend_modes_of_photoshop_count() -> None:
    from psd_tools.constants import BlendMode, Tag

    def change(psd: Any, body: Any, shade: Any) -> None:
        body.tagged_blocks.set_data(Tag.BLEND_FILL_OPACITY, 128)
        shade.blend_mode = BlendMode.MULTIPLY

    found = photoshop(change)
    assert [each.opacity for each in found.layers] == [128, 255]
    assert found.notes.text == "'shade': blend mode multiply shown as normal"


def test_masks_of_photoshop_count_and_so_do_those_of_groups() -> None:
    from psd_tools import PSDImage

    def mask(psd: Any, body: Any, shade: Any) -> None:
        half = np.zeros(SHAPE, np.uint8)
        half[:, :50] = 255
        body.create_mask(Image.fromarray(half))

    found = photoshop(mask).layers[0]
    assert found.left + found.pixels.shape[1] == 50
    group = read_layers(FILES / "psd_group_mask.psd").layers[0]
    psd: Any = PSDImage.open(FILES / "psd_group_mask.psd")
    mask_of_group = np.zeros((64, 64), np.uint8)
    of_group = psd[0].mask
    mask_of_group[of_group.top : of_group.bottom, of_group.left : of_group.right] = of_group.topil()
    rows, columns = group.pixels.shape[:2]
    inside = np.s_[group.top : group.top + rows, group.left : group.left + columns]
    alone = np.asarray(psd[0][0].topil())[..., 3]
    assert (alone > mask_of_group).any()
    assert np.array_equal(group.pixels[..., 3], np.minimum(alone, mask_of_group)[inside])


def descriptor(kind: bytes, block: Any = None, **values: Any) -> Any:
    """A descriptor of Photoshop; keys of four letters, a space where one has fewer."""
    from psd_tools.psd import descriptor as parts

    found = (block or parts.Descriptor)(classID=kind)
    for key, value in values.items():
        found[key.ljust(4).encode()] = value
    return found


def red() -> Any:
    from psd_tools.psd.descriptor import Double

    return descriptor(b"RGBC", Rd=Double(255.0), Grn=Double(0.0), Bl=Double(0.0))


def square(left: float, top: float, right: float, bottom: float) -> Any:
    """A vector mask, in shares of the picture."""
    from psd_tools.psd import vector

    parts: Any = vector  # its lists are typed for any one type of their own
    corners = [(top, left), (top, right), (bottom, right), (bottom, left)]
    knots = [parts.ClosedKnotLinked(each, each, each) for each in corners]
    path = parts.Path([parts.InitialFillRule(0), parts.ClosedPath(knots)])
    return parts.VectorMaskSetting(path=path)


def alpha_of(found: DecodedLayer) -> NDArray[np.int64]:
    """The opacity of a layer in the whole picture."""
    whole = np.zeros(SHAPE, np.int64)
    rows, columns = found.pixels.shape[:2]
    whole[found.top : found.top + rows, found.left : found.left + columns] = found.pixels[..., 3]
    return whole


def test_the_density_of_a_mask_of_photoshop_lets_a_part_through() -> None:
    from psd_tools.psd.layer_and_mask import MaskFlags, MaskParameters

    def mask(psd: Any, body: Any, shade: Any) -> None:
        half = np.zeros(SHAPE, np.uint8)
        half[:, :50] = 255
        body.create_mask(Image.fromarray(half))
        data = body._record.mask_data
        data.flags = MaskFlags(parameters_applied=True)
        data.parameters = MaskParameters(user_mask_density=102)  # 40 %

    found = alpha_of(photoshop(mask).layers[0])
    assert found[44, 45] == 255
    assert found[44, 55] == pytest.approx(153, abs=1)  # what the mask hides, it hides by 40 %


def test_a_vector_mask_of_photoshop_cuts_its_layer() -> None:
    from psd_tools.constants import Tag

    def mask(psd: Any, body: Any, shade: Any) -> None:
        body.tagged_blocks.set_data(Tag.VECTOR_MASK_SETTING1)
        body.tagged_blocks[Tag.VECTOR_MASK_SETTING1].data = square(0, 0, 0.5, 0.5)

    found = alpha_of(photoshop(mask).layers[0]) > 127
    rows, columns = np.nonzero(found)
    assert (int(columns.max()), int(rows.max())) == (59, 39)  # half of 120 × 80
    assert found[30, 50]


def test_a_fill_layer_of_photoshop_without_pixels_fills_its_mask() -> None:
    from psd_tools.constants import Tag
    from psd_tools.psd.descriptor import DescriptorBlock

    def fill(psd: Any, body: Any, shade: Any) -> None:
        shade.tagged_blocks.set_data(Tag.SOLID_COLOR_SHEET_SETTING)
        block = descriptor(b"null", DescriptorBlock)
        block[b"Clr "] = red()
        shade.tagged_blocks[Tag.SOLID_COLOR_SHEET_SETTING].data = block
        shade.tagged_blocks.set_data(Tag.VECTOR_MASK_SETTING1)
        shade.tagged_blocks[Tag.VECTOR_MASK_SETTING1].data = square(0.25, 0.25, 0.75, 0.75)
        record = shade._record
        record.top = record.left = record.bottom = record.right = 0
        for channel in shade._channels:
            channel.data = b""

    found = photoshop(fill)
    assert [each.name for each in found.layers] == ["body", "shade"]
    shape = alpha_of(found.layers[1]) > 127
    rows, columns = np.nonzero(shape)
    box = [int(each) for each in (columns.min(), columns.max(), rows.min(), rows.max())]
    assert box == [30, 89, 20, 59]
    assert (found.layers[1].pixels[5, 5, :3] == (255, 0, 0)).all()
    assert not found.notes.text


def test_a_stroke_of_photoshop_is_drawn_and_a_shadow_named() -> None:
    from psd_tools.constants import Tag
    from psd_tools.psd.descriptor import Bool, DescriptorBlock2, Enumerated, UnitFloat
    from psd_tools.terminology import Unit

    def outlined(psd: Any, body: Any, shade: Any) -> None:
        stroke = descriptor(
            b"FrFX",
            enab=Bool(True),
            present=Bool(True),
            Styl=Enumerated(b"FStl", b"OutF"),
            PntT=Enumerated(b"FrFl", b"SClr"),
            Md=Enumerated(b"BlnM", b"Nrml"),
            Opct=UnitFloat(100.0, Unit.Percent),
            Sz=UnitFloat(4.0, Unit.Pixels),
            Clr=red(),
        )
        shadow = descriptor(b"DrSh", enab=Bool(True), present=Bool(True))
        block = descriptor(b"null", DescriptorBlock2, FrFX=stroke, DrSh=shadow, masterFXSwitch=Bool(True))
        block.version = 0
        body.tagged_blocks.set_data(Tag.OBJECT_BASED_EFFECTS_LAYER_INFO)
        body.tagged_blocks[Tag.OBJECT_BASED_EFFECTS_LAYER_INFO].data = block

    plain = alpha_of(photoshop(lambda psd, body, shade: None).layers[0]) > 127
    found = photoshop(outlined)
    grown = alpha_of(found.layers[0]) > 127
    assert found.notes.text == "'body': drop shadow left out"
    left, right = np.flatnonzero(plain[44])[[0, -1]]
    assert np.flatnonzero(grown[44])[[0, -1]].tolist() == pytest.approx([left - 4, right + 4], abs=1)
    edge = found.layers[0].pixels[44 - found.layers[0].top, left - 2 - found.layers[0].left]
    assert edge[:3].tolist() == [255, 0, 0]


def test_an_animated_krita_file_says_what_of_it_is_used(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = FILES / "two_frames.kra"
    found = read_layers(path)
    assert "it is animated in Krita; the frame 5, at which it was saved, is used" in found.notes.text
    assert (found.layers[0].left, found.layers[0].top) == (27, 27)
    assert generate(str(path)) == 0
    words = "it is animated in Krita; the picture that Krita merged when it was saved is used"
    assert words in capsys.readouterr().err


KINDS_SHOWN = ("PSD", "KRA", "ORA", "Aseprite")
_APPLIED, _NORMAL, _OUT, _NONE = "applied", "shown as normal, named", "left out, named", ""
TREATMENT = {
    "layer opacity": ("kept", "kept", "kept", "kept"),
    "fill opacity": (_APPLIED, _NONE, _NONE, _NONE),
    "layer mask": (_APPLIED, _APPLIED, _NONE, _NONE),
    "group mask": (_APPLIED, _APPLIED, _NONE, _NONE),
    "mask density": (_APPLIED, _NONE, _NONE, _NONE),
    "vector mask": (_APPLIED, _NONE, _NONE, _NONE),
    "clipping": ("applied and kept", _OUT, _OUT, _NONE),
    "stroke and overlay effects": (_APPLIED, _NONE, _NONE, _NONE),
    "shadow, glow, bevel and satin": (_OUT, _OUT, _NONE, _NONE),
    "fill layer": (_APPLIED, _OUT, _NONE, _NONE),
    "shape or vector layer": (_APPLIED, _OUT, _NONE, _NONE),
    "text or smart object": ("its pixels; without them left out, named", _NONE, _NONE, _NONE),
    "adjustment or filter layer": (_OUT, _OUT, _NONE, _NONE),
    "filter, transform or colorize mask": (_NONE, _OUT, _NONE, _NONE),
    "file or clone layer": (_NONE, _OUT, _NONE, _NONE),
    "blend mode": (_NORMAL, _NORMAL, _NORMAL, _NORMAL),
    "animation": (_NONE, "one frame, named", _NONE, "all frames"),
    "tilemap": (_NONE, _NONE, _NONE, "applied; a tileset in another file is left out, named"),
}
"""Treatment of each layer feature in each of `KINDS_SHOWN`; the documentation has the same table."""


def test_the_documentation_has_the_table_of_what_is_shown() -> None:
    page = Path(__file__).parents[3] / "docs" / "generate.md"
    rows = [f"| {feature} | {' | '.join(each)} |".replace("|  ", "| ") for feature, each in TREATMENT.items()]
    assert "\n".join(
        [f"| feature | {' | '.join(KINDS_SHOWN)} |", "| --- | --- | --- | --- | --- |", *rows]
    ) in page.read_text(encoding="utf-8")
