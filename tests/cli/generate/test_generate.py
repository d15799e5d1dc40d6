import io
import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normal_pngs import read_png
from normalgan.__main__ import main
from pens import blob, outline, overlap

FILLED = blob()
INK = outline(FILLED)
GREY = np.rint(255 * (1 - INK)).astype(np.uint8)
SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="20mm" viewBox="0 0 300 200">
<circle cx="170" cy="90" r="60" fill="white" stroke="black" stroke-width="3"/></svg>"""


@pytest.fixture
def here(here: Path) -> Path:
    """A drawing, fox.png, beside the model."""
    Image.fromarray(GREY).save("fox.png")
    return here


def generate(*arguments: str) -> int:
    return main(["generate", *arguments, "--model", "model.onnx"])


def predicted(path: str) -> NDArray[np.float32]:
    return read_png(path)[0]


def on_object(normals: NDArray[np.float32]) -> NDArray[np.bool_]:
    return np.asarray(np.abs(normals[..., :2]).max(-1) > 0.02)


def save(kind: str) -> str:
    """Write the drawing in a format and return the file's name."""
    grey = Image.fromarray(GREY)
    match kind:
        case "exif.jpg":
            exif = Image.Exif()
            exif[0x0112] = 8  # to be turned by 90° counter-clockwise
            grey.transpose(Image.Transpose.ROTATE_270).save("a.jpg", exif=exif, quality=90)
            return "a.jpg"
        case "rgba.png":
            Image.merge("RGBA", [Image.new("L", grey.size, 0)] * 3 + [Image.fromarray(255 - GREY)]).save(
                "a.png"
            )
            return "a.png"
        case "inverted.webp":
            Image.fromarray(255 - GREY).save("a.webp", quality=90)
            return "a.webp"
        case "16.png":
            Image.fromarray(GREY.astype(np.uint16) * 257).save("a.png")
            return "a.png"
        case _:
            grey.convert("RGB").save(f"a.{kind}")
    return f"a.{kind}"


@pytest.mark.parametrize(
    "kind", ["png", "16.png", "rgba.png", "jpg", "exif.jpg", "webp", "inverted.webp", "bmp", "tif", "gif"]
)
def test_every_format_gives_the_same_map(here: Path, kind: str) -> None:
    assert generate("fox.png", save(kind), "-o", "out") == 0
    reference, other = predicted("out/fox_normal.png"), predicted("out/a_normal.png")
    assert overlap(on_object(other), on_object(reference)) > 0.97
    both = on_object(other) & on_object(reference)
    assert np.abs(other - reference)[both].mean() < 0.02


def test_an_svg_is_drawn_at_the_size_asked_for(here: Path) -> None:
    Path("ball.svg").write_text(SVG)
    y, x = np.mgrid[:200, :300] + 0.5
    disc = np.hypot(x - 170, y - 90) < 61.5
    for size in (300, 1024):
        assert generate("ball.svg", "-o", "out", *(["--size", "300"] if size == 300 else [])) == 0
        normals = predicted("out/ball_normal.png")
        assert normals.shape[1] == size
        assert normals.shape[0] == pytest.approx(size / 1.5, rel=0.015)  # resvg rounds millimetres to pixels
        found = cv2.resize(on_object(normals).astype(np.uint8), (300, 200), interpolation=cv2.INTER_NEAREST)
        assert overlap(found, disc) > 0.93  # where the ramp faces the viewer it looks like paper


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--bits", "16"], "fox_normal.png"),
        (["--format", "exr"], "fox_normal.exr"),
        (["--alpha", "--pad", "0"], "fox_normal.png"),
        (["--alpha", "--pad", "0", "--format", "tiff"], "fox_normal.tiff"),
    ],
)
def test_every_output_holds_the_same_normals(here: Path, arguments: list[str], name: str) -> None:
    assert generate("fox.png", "-o", "plain") == 0
    assert generate("fox.png", "-o", "out", *arguments) == 0
    assert [path.name for path in Path("out").iterdir()] == [name]
    colours, depth = read_any(Path("out") / name)
    assert colours.shape == (200, 300, 4 if "--alpha" in arguments else 3)
    truth = read_any(Path("plain/fox_normal.png"))[0]
    same = np.abs(colours[..., :3] - truth).max(-1) <= (0.51 if depth > 8 else 0) / 255
    if "--alpha" in arguments:
        alpha = colours[..., 3]
        assert overlap(alpha, np.maximum(FILLED, INK > 0.5)) > 0.94
        # The edge is soft, and has normals as far as it is seen.
        rim = (alpha > 0) & (alpha < 1)
        assert 0 < rim.mean() < 0.06
        assert np.unique(alpha[rim]).size > 1
        same |= rim
    assert same.all()


def read_any(path: Path) -> tuple[NDArray[np.float32], int]:
    """Return the colours of a file by a library that did not write it where there is one, and its bits."""
    if path.suffix == ".exr":
        import OpenEXR

        channels = OpenEXR.File(str(path)).channels()
        return next(iter(channels.values())).pixels, 32
    if path.suffix == ".tiff":
        import tifffile

        return tifffile.imread(path), 32
    pixels = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert pixels is not None
    order = [2, 1, 0, 3][: pixels.shape[2]]
    return (pixels[..., order] / (255 if pixels.dtype == np.uint8 else 65535)).astype(
        np.float32
    ), 8 * pixels.itemsize


def test_green_can_point_down(here: Path) -> None:
    assert generate("fox.png", "-o", "up") == generate("fox.png", "-o", "down", "--y", "down") == 0
    up, down = predicted("up/fox_normal.png"), predicted("down/fox_normal.png")
    assert np.abs(up * (1, -1, 1) - down).max() < 0.02
    assert up[40, 170, 1] > 0.1 > -0.1 > up[140, 170, 1]  # the ramp's y grows upwards


def test_folders_globs_and_standard_input(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("in").mkdir()
    for name in ("a.png", "b.jpg"):
        Image.fromarray(GREY).save(f"in/{name}")
    assert generate("in", "-o", "in", "--show-input") == 0
    # A second run does not take the maps for drawings.
    assert generate("in", "-o", "in", "--show-input") == 0
    names = {"a.png", "b.jpg", "a_normal.png", "b_normal.png", "a_input.png", "b_input.png"}
    assert {path.name for path in Path("in").iterdir()} == names
    assert generate("in/*.jpg", "-o", "glob", "--suffix", "_n") == 0
    assert [path.name for path in Path("glob").iterdir()] == ["b_n.png"]
    with Path("fox.png").open("rb") as file:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(file.read())))
    assert generate("-", "-o", "piped") == 0
    assert generate("fox.png", "-o", "named") == 0
    assert Path("piped/stdin_normal.png").read_bytes() == Path("named/fox_normal.png").read_bytes()


def test_the_input_that_is_shown_is_what_the_model_saw(here: Path) -> None:
    assert generate("fox.png", "-o", "out", "--show-input") == 0
    with Image.open("out/fox_input.png") as image:
        assert image.size == (64, 64)
        assert np.asarray(image).min() < 30
        assert np.median(np.asarray(image)) == 255


def test_masks_and_hints_go_with_their_drawings(here: Path) -> None:
    mask = np.zeros((200, 300), np.uint8)
    mask[60:120, 140:200] = 255
    Path("extra").mkdir()
    Image.fromarray(mask).save("extra/fox_mask.png")
    Path("extra/fox_hints.json").write_text(json.dumps([{"x": 150, "y": 100, "normal": [-0.8, 0, 0.6]}]))
    assert generate("fox.png", "-o", "out", "--mask", "extra", "--hints", "extra") == 0
    normals = predicted("out/fox_normal.png")
    # The ramp is (0, 0, 1) somewhere in the mask too.
    assert overlap(on_object(normals), mask) > 0.9
    assert normals[100, 150, 0] < -0.6
    assert normals[70, 190, 0] > 0


def test_one_bad_file_stops_no_other(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("text.png").write_text("no picture")
    Image.new("L", (50, 50), 255).save("white.png")
    assert generate("text.png", "white.png", "fox.png", "-o", "out") == 1
    said = capsys.readouterr()
    assert said.out.split() == [str(Path("out/fox_normal.png"))]
    assert [path.name for path in Path("out").iterdir()] == ["fox_normal.png"]
    assert "text.png is not an image that can be read" in said.err
    assert "white.png: no lines were found in it" in said.err
    assert "For a wall or another surface, add --tile both." in said.err
    assert "2 of 3 sketches could not be used" in said.err


def test_a_dry_run_writes_nothing(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Image.fromarray(255 - GREY).save("fox_mask.png")
    assert generate("fox.png", "--mask", ".", "--dry-run") == 0
    assert capsys.readouterr().out == f"fox.png with fox_mask.png -> {Path('normals/fox_normal.png')}\n"
    assert not Path("normals").exists()


def test_the_same_drawing_gives_the_same_bytes_alone_and_among_others(here: Path) -> None:
    for name in ("a.png", "b.png", "c.png"):
        Image.fromarray(GREY if name == "b.png" else np.roll(GREY, 9, 1)).save(name)
    for kind in ("png", "exr", "tiff"):
        assert generate("fox.png", "-o", "one", "--format", kind) == 0
        assert generate("a.png", "b.png", "c.png", "-o", "many", "--format", kind) == 0
        assert Path(f"one/fox_normal.{kind}").read_bytes() == Path(f"many/b_normal.{kind}").read_bytes()


def test_a_full_disk_leaves_nothing_half_written(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(file: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("normalgan.files.writing.os.fsync", full)
    assert generate("fox.png", "-o", "out") == 1
    assert f"cannot be written to {Path('out/fox_normal.png')}: No space left" in capsys.readouterr().err
    assert not list(Path("out").iterdir())


def test_it_loads_neither_torch_nor_what_only_others_need() -> None:
    code = (
        "import sys, normalgan.cli.generate.command; "
        "heavy = {'torch', 'lightning', 'kornia', 'trimesh', 'skimage', 'matplotlib'}; "
        "sys.exit(bool(heavy & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["none.png"], "no sketch found at 'none.png'"),
        (["fox.png", "--model", "none.onnx"], "there is no model none.onnx"),
        (["fox.png", "--model", "shippd"], "there is no model shippd; give a file (.onnx), an address "),
        (["fox.png", "--model", "shippd"], "Did you mean shipped?"),
        (["fox.png", "--model", "fox.png"], "fox.png is not a model that ONNX Runtime can run"),
        (["fox.png", "--mask", "none"], "there is no file or folder none for the mask"),
        (["fox.png", "--mask", "empty"], "empty holds no mask for any sketch"),
        (["fox.png", "--hints", "empty"], "empty holds no hints for any sketch"),
        (["fox.png", "--hints", "fox.png"], "the hints fox.png have no transparency"),
        (["fox.png", "--mask", "small.png"], "the mask small.png is 9 × 9 pixels, but its sketch 300 × 200"),
        (
            ["fox.png", "small.png", "--mask", "small.png"],
            "small.png holds the mask of one sketch, but there are 2; name a folder.",
        ),
        (["fox.png", "-o", ".", "--suffix", ""], "fox.png is an input and would be overwritten"),
        (["fox.png", "--suffix", "_input", "--show-input"], "fox_input.png would be written twice"),
        (["fox.png", "--suffix", "a/b"], "the suffix 'a/b' cannot end a file's name"),
        (["fox.png", "--suffix", "_n:"], "the suffix '_n:' cannot end a file's name"),
        (["fox.png", "--height"], "--height needs a value: png or tiff."),
        (["fox.png", "--size", "3"], "--size: 3 is out of range; it must be >= 8 and <= 8192."),
        (["fox.png", "--bits", "16", "--format", "exr"], "bits apply to PNG; a map as exr"),
        (["fox.png", "--bits", "12"], "expected one of"),
        (["fox.png", "--y", "left"], "expected one of"),
        (["fox.png", "--widht", "3"], "there is no option --widht."),
        (["fox.png", "--show_mask"], "there is no option --show_mask. Did you mean --show-mask?"),
        (["fox.png", "--hints", "fox.csv"], "the hints fox.csv are neither a list (.json) nor painted"),
        ([], "missing: sketches."),
    ],
)
def test_what_cannot_be_used_is_told_in_a_sentence(
    here: Path, arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("empty").mkdir()
    Image.new("L", (9, 9), 0).save("small.png")
    Path("fox.csv").write_text("x,y,normal")
    before = sorted(here.rglob("*"))
    model = [] if "--model" in arguments else ["--model", "model.onnx"]
    assert main(["generate", *arguments, *model]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert sorted(here.rglob("*")) == before


def test_without_a_model_it_says_so(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("normalgan.weights.shipped.SHIPPED", here / "none.onnx")
    assert main(["generate", "fox.png"]) == 2
    assert "no model comes with this package" in capsys.readouterr().err


def test_help_ends_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "--help"]) == 0
    out = capsys.readouterr().out
    assert "predict normal maps" in out.lower()
    assert "type:" not in out  # as Python spells it, which no artist reads


def test_previews_heights_and_reliefs_come_beside_the_map(here: Path) -> None:
    import trimesh

    assert generate("fox.png", "-o", "out", "--preview", "gif", "--height", "tiff", "--relief", "glb") == 0
    assert generate("fox.png", "-o", "png", "--preview", "png", "--height", "png", "--relief", "obj") == 0
    assert {path.name for path in Path("out").iterdir()} == {
        "fox_normal.png", "fox_preview.gif", "fox_height.tiff", "fox_relief.glb",
    }  # fmt: skip
    with Image.open("out/fox_preview.gif") as gif, Image.open("png/fox_preview.png") as sheet:
        assert getattr(gif, "n_frames", 1) > 1
        assert gif.size == (300, 200)
        assert min(sheet.size) > 200
    exact, levels = (
        cv2.imread(name, cv2.IMREAD_UNCHANGED) for name in ("out/fox_height.tiff", "png/fox_height.png")
    )
    assert exact is not None
    assert levels is not None
    assert exact.dtype == np.float32
    assert levels.dtype == np.uint16
    inside = cv2.erode(FILLED, np.ones((5, 5))) > 0
    assert np.corrcoef(exact[inside], levels[inside])[0, 1] > 0.999
    # The ramp leans outwards on all sides, as a dome does.
    for row, column in ((90, 120), (90, 220), (140, 170), (45, 170)):
        assert exact[85, 160] > exact[row, column] + 3
    assert trimesh.load_mesh("out/fox_relief.glb").is_volume
    assert Path("png/fox_relief.obj").stat().st_size > 1000


@pytest.mark.parametrize("tile", ["both", "x", "y"])
def test_a_drawing_that_repeats_gives_maps_that_do(here: Path, tile: str) -> None:
    # Rolled by half, what was the seam lies in the midst; by the predictor's own tests that is the same.
    Image.fromarray(GREY[:, :200]).save("stone.png")
    assert generate("stone.png", "-o", "out", "--tile", tile, "--height", "png", "--ao") == 0
    assert {path.name for path in Path("out").iterdir()} == {
        *("stone_normal.png", "stone_height.png", "stone_ao.png")
    }
    assert generate("stone.png", "-o", "plain") == 0
    assert predicted("out/stone_normal.png").shape == predicted("plain/stone_normal.png").shape
    assert not np.allclose(predicted("out/stone_normal.png"), predicted("plain/stone_normal.png"), atol=0.05)


@pytest.mark.parametrize(
    "others",
    [("--sheet", "2x1"), ("--split", "auto"), ("--atlas", "fox.json"), ("--layers",), ("--frame", "shared")],
)
def test_what_makes_no_sense_with_a_drawing_that_repeats_is_refused(
    here: Path, capfd: pytest.CaptureFixture[str], others: tuple[str, ...]
) -> None:
    assert generate("fox.png", "--tile", "both", *others) == 2
    error = capfd.readouterr().err
    assert error.count("\n") == 1
    assert "--tile" in error
    assert f"{others[0]}" in error


def test_an_animation_is_not_repeated(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    frames = [Image.fromarray(np.roll(GREY, i, 1)) for i in range(3)]
    frames[0].save("walk.gif", save_all=True, append_images=frames[1:])
    assert generate("walk.gif", "--tile", "both") == 2
    assert capfd.readouterr().err == (
        "normalgan: walk.gif is an animation; --tile repeats a still picture.\n"
    )


def test_stages_of_the_mask_are_explained(here: Path) -> None:
    assert generate("fox.png", "--explain", "why/deep") == 0
    stages = ("1_input", "2_ink", "3_regions", "4_presence", "5_mask")
    assert sorted(each.name for each in Path("why/deep").iterdir()) == [f"fox_{each}.png" for each in stages]
    for each in stages:
        assert np.asarray(Image.open(f"why/deep/fox_{each}.png")).shape[:2] == (200, 300), each
    assert overlap(np.asarray(Image.open("why/deep/fox_5_mask.png")) > 127, FILLED) > 0.94
    assert generate("fox.png", "--mask", "outline", "--explain", "plain") == 0
    assert not Path("plain/fox_4_presence.png").exists()


def test_chalk_on_nothing_is_explained_on_the_black_that_the_reader_sees(here: Path) -> None:
    chalk = np.dstack([np.full_like(GREY, 255)] * 3 + [255 - GREY])
    Image.fromarray(chalk).save("chalk.png")
    assert generate("chalk.png", "--explain", "why") == 0
    shown = np.asarray(Image.open("why/chalk_1_input.png").convert("L"))
    assert shown[GREY > 250].max() < 10
    assert shown[GREY < 5].min() > 245


def test_a_hole_is_cut_where_a_point_says(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert generate("fox.png", "--alpha") == 0
    assert np.asarray(Image.open("normals/fox_normal.png"))[90, 170, 3] == 255
    assert generate("fox.png", "--alpha", "--hole", "170,90") == 0
    assert np.asarray(Image.open("normals/fox_normal.png"))[90, 170, 3] == 0
    capfd.readouterr()
    for point, sentence in (
        ("5,5", "fox.png: no enclosed region lies at x 5, y 5; give a point inside closed lines"),
        ("5", "--hole 5 is not a point; give x,y in pixels of the drawing"),
        ("nan,5", "--hole nan,5 is not a point"),
        ("5,inf", "--hole 5,inf is not a point"),
    ):
        assert generate("fox.png", "--hole", point) == 2
        assert sentence in capfd.readouterr().err
    Image.open("fox.png").reduce(4).save("icon.png")  # worked on at the model's size
    assert generate("icon.png", "--hole", "2,2") == 2
    assert "icon.png: no enclosed region lies at x 2, y 2;" in capfd.readouterr().err
    Image.fromarray(255 - GREY).save("other.png")
    assert generate("fox.png", "other.png", "--hole", "170,90") == 2
    assert "a hole is a point of one drawing, but there are 2" in capfd.readouterr().err
    assert generate("fox.png", "--hole", "170,90", "--mask", "model") == 2
    assert "the mask does not come from the lines" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("option", "others"),
    [
        (("--hole", "1,1"), ("--tile", "both")),
        (("--explain", "why"), ("--layers",)),
        (("--single",), ("--tile", "both")),
    ],
)
def test_options_on_a_mask_are_refused_where_there_is_no_single_drawing(
    here: Path, capfd: pytest.CaptureFixture[str], option: tuple[str, ...], others: tuple[str, ...]
) -> None:
    assert generate("fox.png", *option, *others) == 2
    assert f"{option[0]} is about the mask of a single drawing" in capfd.readouterr().err


def test_figures_of_a_page_are_predicted_separately_unless_they_are_one(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = np.hstack([GREY[:, 80:260], GREY[:, 80:260], GREY[:, 80:260]])
    Image.fromarray(page).save("page.png")
    assert generate("page.png", "--alpha", "--hole", "450,90", "--explain", "why") == 0
    assert "page.png: it shows 3 separate figures, each predicted separately" in capsys.readouterr().err
    found = np.asarray(Image.open("normals/page_normal.png"))
    assert found.shape[:2] == page.shape
    assert found[90, [90, 270], 3].tolist() == [255, 255]
    assert found[90, 450, 3] == 0
    assert (
        len(list(Path("why").glob("page_?_*.png")))
        == len(list(Path("why").glob("page_figure_3_?_*.png")))
        == 5
    )
    third = np.asarray(Image.open("why/page_figure_3_5_mask.png")) > 0
    assert third.sum() == (found[:, 360:, 3] > 127).sum() > 1000
    assert np.abs(found[60:120, 60:120, :3].astype(int) - found[60:120, 240:300, :3]).max() < 16
    assert generate("page.png", "--single") == 0
    assert "separate figures" not in capsys.readouterr().err


def test_figures_are_predicted_separately_with_the_mask_of_their_outlines_too(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = GREY[:, 80:260]
    Image.fromarray(part).save("one.png")
    Image.fromarray(np.hstack([part, part])).save("page.png")
    assert generate("one.png", "page.png", "--mask", "outline", "--alpha", "--pad", "0") == 0
    assert "page.png: it shows 2 separate figures" in capsys.readouterr().err
    one, page = (np.asarray(Image.open(f"normals/{name}_normal.png")) for name in ("one", "page"))
    assert np.abs(page[60:120, 240:300].astype(int) - one[60:120, 60:120]).max() < 16
