"""Layered files of paint programs: real ones, written here, are painted as the flat picture is."""

import io
import re
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence

from normalgan.__main__ import main
from normalgan.decoding import decode, decode_frames, decode_layers, decode_tileset
from normalgan.errors import InputError
from pens import blob, outline

Pixels = NDArray[np.uint8]
FILLED = blob((80, 120), (60, 44), 28)
FLAT = np.dstack([np.rint(255 * (1 - outline(FILLED)))] * 3 + [np.full(FILLED.shape, 255)]).astype(np.uint8)


def zipped(mimetype: str, **files: bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        file.writestr("mimetype", mimetype)
        for name, content in files.items():
            file.writestr(name.replace("_", "."), content)
    return out.getvalue()


def png(pixels: Pixels) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def psd(pixels: Pixels) -> bytes:
    from psd_tools import PSDImage

    out = io.BytesIO()
    PSDImage.frompil(Image.fromarray(pixels).convert("RGB")).save(out)
    return out.getvalue()


def chunk(kind: int, data: bytes) -> bytes:
    return struct.pack("<IH", len(data) + 6, kind) + data


def layer(
    name: str,
    visible: bool = True,
    opacity: int = 255,
    kind: int = 0,
    level: int = 0,
    flags: int = 0,
    blend: int = 0,
) -> bytes:
    text = name.encode()
    head = struct.pack("<HHHHHHB3x", int(visible) | flags, kind, level, 0, 0, blend, opacity)
    ending = struct.pack("<I", 0) if kind == 2 else b""
    return chunk(0x2004, head + struct.pack("<H", len(text)) + text + ending)


def cel(number: int, pixels: Pixels, left: int = 0, top: int = 0, raised: int = 0) -> bytes:
    head = struct.pack("<HhhBHh5x", number, left, top, 255, 2, raised)
    size = struct.pack("<HH", pixels.shape[1], pixels.shape[0])
    return chunk(0x2005, head + size + zlib.compress(pixels.tobytes()))


def linked(number: int, frame: int) -> bytes:
    return chunk(0x2005, struct.pack("<HhhBHh5xH", number, 0, 0, 255, 1, 0, frame))


def tiles(number: int, which: NDArray[np.uint32]) -> bytes:
    """A cel of tiles: numbers with the flips along x, y and the diagonal in the upper bits."""
    head = struct.pack("<HhhBHh5x", number, 0, 0, 255, 3, 0)
    flips = 1 << 31, 1 << 30, 1 << 29
    size = struct.pack("<HHHIIII10x", which.shape[1], which.shape[0], 32, 0x1FFFFFFF, *flips)
    return chunk(0x2005, head + size + zlib.compress(which.astype("<u4").tobytes()))


def tileset(pixels: Pixels, inside: bool = True) -> bytes:
    """A tileset of 4 × 4 pixels a tile, the first of which is empty."""
    head = struct.pack("<IIIHHh14xH", 0, 2 + 4 if inside else 1 + 4, len(pixels) // 4, 4, 4, 1, 0)
    packed = zlib.compress(pixels.tobytes())
    return chunk(0x2023, head + (struct.pack("<I", len(packed)) + packed if inside else bytes(8)))


def aseprite(
    frames: list[list[bytes]], size: tuple[int, int] = (120, 80), depth: int = 32, flags: int = 1
) -> bytes:
    body = b""
    for chunks in frames:
        data = b"".join(chunks)
        body += struct.pack("<IHHH2xI", 16 + len(data), 0xF1FA, len(chunks), 90, len(chunks)) + data
    head = struct.pack("<IHHHHHIH8xB", 128 + len(body), 0xA5E0, len(frames), *size, depth, flags, 100, 0)
    return head.ljust(128, b"\0") + body


def drawn() -> list[bytes]:
    """Paper, a drawing in two halves, one of which lies elsewhere in its layer, and a hidden layer."""
    paper = np.full((80, 120, 4), 255, np.uint8)
    hidden = np.zeros((80, 120, 4), np.uint8)
    hidden[..., 3] = 255
    return [
        *(layer("paper"), layer("left"), layer("right"), layer("hidden", visible=False)),
        *(cel(0, paper), cel(1, FLAT[:, :60]), cel(2, FLAT[:, 60:], left=60), cel(3, hidden)),
    ]


def indexed() -> bytes:
    colours = b"".join(struct.pack("<HBBBB", 0, value, value, value, 255) for value in range(256))
    palette = chunk(0x2019, struct.pack("<III8x", 256, 0, 255) + colours)
    return aseprite([[palette, layer("a"), cel(0, np.maximum(FLAT[..., 0], 1))]], depth=8)


FILES = {
    "a.psd": psd(FLAT),
    "a.ora": zipped("image/openraster", mergedimage_png=png(FLAT)),
    "a.kra": zipped("application/x-krita", mergedimage_png=png(FLAT), maindoc_xml=b"<DOC/>"),
    "a.aseprite": aseprite([drawn()]),
    "b.ase": indexed(),
}


@pytest.mark.parametrize("name", FILES)
def test_what_a_layered_file_shows_is_what_is_read(name: str) -> None:
    found = decode(name, FILES[name], (8, 8192), 64)
    assert found.shape == (80, 120)
    assert np.abs(found.pixels[..., :3].astype(int) - FLAT[..., :3]).max() <= 1


@pytest.mark.usefixtures("here")
def test_layered_files_are_painted_in_folders_too() -> None:
    Path("in").mkdir()
    for number, (name, content) in enumerate(FILES.items()):
        Path(f"in/{number}{name}").write_bytes(content)
    walk = aseprite([drawn(), [linked(0, 0), cel(1, FLAT[:, :60])]])
    Path("in/walk.ase").write_bytes(walk)
    Path("flat.png").write_bytes(png(FLAT))
    assert main(["generate", "in", "flat.png", "--model", "model.onnx"]) == 0
    flat = Path("normals/flat_normal.png").read_bytes()
    for number, name in enumerate(FILES):
        found = Path(f"normals/{number}{Path(name).stem}_normal.png")
        assert found.read_bytes() == flat or name == "b.ase", name  # whose black is one level lighter
    with Image.open("normals/walk_normal.png") as moving:
        assert [int(each.info["duration"]) for each in ImageSequence.Iterator(moving)] == [90, 90]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"8BPS" + struct.pack(">H", 3) + FILES["a.psd"][6:], "is a PSD of version 3; 1 and 2 can be read"),
        (FILES["a.psd"][:60], "cannot be read as an image"),
        (zipped("image/openraster"), "is a ZIP without mergedimage.png"),
        (FILES["a.ora"][:200], "is a broken ZIP"),
        (aseprite([drawn()], depth=24), "is an Aseprite file of 24 bits"),
        (FILES["a.aseprite"][:300], "broken"),
        (aseprite([[layer("a"), chunk(0x2005, bytes(16))]]), "has a broken layer 'a'"),
        (b"CSFCHUNK" + bytes(99), "is a Clip Studio Paint file, which cannot be read; save it as PSD"),
        (
            b"GCPF" + bytes(99),
            "is a Pixelorama project, which cannot be read; export it from Pixelorama as PNG",
        ),
        (zipped("a", data_json=b"{}"), "is a Pixelorama project, which cannot be read"),
        (FILES["a.aseprite"][:132] + b"\1\1" + FILES["a.aseprite"][134:], "of an unknown version"),
        (aseprite([drawn()], size=(60000, 60000)), "is 60000 × 60000 pixels"),
    ],
)
def test_a_layered_file_that_cannot_be_read_is_told_in_a_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        decode("a.any", content, (8, 8192), 64)
    assert sentence in str(caught.value)


def shown(content: bytes) -> list[int]:
    """What a file of four pixels a colour shows, one of each."""
    return [int(each) for each in decode("a.ase", content, (8, 8192), 64).pixels[0, ::4].reshape(-1)]


def index(*values: int) -> Pixels:
    return np.tile(np.repeat(np.array(values, np.uint8), 4), (8, 1))


@pytest.mark.parametrize(("kind", "brightest"), [(0x0004, 255), (0x0011, 63)])
def test_the_colours_of_a_new_aseprite_are_read_where_it_writes_the_old_chunk(
    kind: int, brightest: int
) -> None:
    # Two runs: colour 1, and after one that is passed over colours 3 and 4.
    runs = struct.pack("<HBB3BBB6B", 2, 1, 1, brightest, 0, 0, 1, 2, 0, brightest, 0, *[brightest] * 3)
    content = aseprite([[chunk(kind, runs), layer("a"), cel(0, index(1, 3, 4))]], (12, 8), depth=8)
    assert shown(content) == [*(255, 0, 0, 255), *(0, 255, 0, 255), *(255, 255, 255, 255)]
    new = chunk(0x2019, struct.pack("<III8xHBBBB", 256, 1, 1, 0, 9, 9, 9, 255))
    both = aseprite([[new, chunk(kind, runs), layer("a"), cel(0, index(1, 1))]], (8, 8), depth=8)
    assert shown(both)[:3] == [9, 9, 9]


def test_layers_of_aseprite_count_as_it_shows_them() -> None:
    palette = chunk(0x2019, struct.pack("<III8xHBBBBHBBBB", 2, 0, 1, 0, 7, 7, 7, 255, 0, 250, 250, 250, 255))
    # In a background no colour is transparent.
    ground = aseprite([[palette, layer("paper", flags=8), cel(0, index(0, 1))]], (8, 8), depth=8)
    assert shown(ground) == [7, 7, 7, 255, 250, 250, 250, 255]

    def plain(value: int) -> Pixels:
        return np.full((8, 8, 4), (value, value, value, 255), np.uint8)

    # A photograph to draw after is not exported by Aseprite either.
    drawn = [layer("pen"), layer("photo", flags=64), cel(0, plain(20)), cel(1, plain(200))]
    assert shown(aseprite([drawn], (8, 8)))[:4] == [20, 20, 20, 255]
    raised = [layer("low"), layer("high"), cel(0, plain(20), raised=2), cel(1, plain(200))]
    assert shown(aseprite([raised], (8, 8)))[:4] == [20, 20, 20, 255]
    old = aseprite([[layer("pen", opacity=0), cel(0, plain(20))]], (8, 8), flags=0)
    assert shown(old)[:4] == [20, 20, 20, 255]
    group = [layer("group", kind=1, opacity=51), layer("pen", level=1), cel(1, plain(20))]
    assert [shown(aseprite([group], (8, 8), flags=each))[3] for each in (1, 3)] == [255, 51]


def test_an_index_outside_the_palette_is_transparent() -> None:
    palette = chunk(0x2019, struct.pack("<III8xHBBBBHBBBB", 2, 0, 1, 0, 7, 7, 7, 255, 0, 250, 250, 250, 255))
    assert shown(aseprite([[palette, layer("a"), cel(0, index(1, 9))]], (8, 8), depth=8)) == [
        *(250, 250, 250, 255),
        *(0, 0, 0, 0),
    ]


@pytest.mark.parametrize("frame", [0, 1, 7])
def test_a_link_to_a_frame_without_that_cel_shows_nothing(frame: int) -> None:
    plain = np.full((8, 8, 4), (20, 20, 20, 255), np.uint8)
    content = aseprite([[layer("a"), layer("b"), cel(0, plain)], [cel(0, plain), linked(1, frame)]], (8, 8))
    frames = decode_frames("a.ase", content, (8, 64))
    assert [each.pixels[0, 0].tolist() for each in frames.frames] == [[20, 20, 20, 255]] * 2
    assert not frames.notes.text


def test_tilemaps_are_read_with_their_flips() -> None:
    tile = np.zeros((4, 4, 4), np.uint8)
    tile[..., 0], tile[..., 1], tile[..., 3] = 10 * np.arange(16).reshape(4, 4), 200, 255
    which = np.array([[1, 1 | 1 << 31, 1 | 1 << 30], [1 | 1 << 29, 1 | 1 << 31 | 1 << 29, 0]], np.uint32)
    strip = np.vstack([np.full_like(tile, 99), tile])
    content = aseprite([[tileset(strip), layer("ground", kind=2), tiles(0, which)]], (12, 8))
    found = decode("a.ase", content, (8, 64), 64).pixels
    turned = tile.transpose(1, 0, 2)
    expected = np.vstack(
        [
            np.hstack([tile, tile[:, ::-1], tile[::-1]]),
            np.hstack([turned, turned[:, ::-1], np.zeros_like(tile)]),
        ]
    )
    assert np.array_equal(found, expected)
    assert len(decode_layers("a.ase", content, (8, 64)).layers) == 1
    own, size = decode_tileset("a.ase", content, (4, 64))
    assert size == (4, 4)
    assert np.array_equal(own.pixels, strip)
    with pytest.raises(InputError, match=r"^a\.ase has no tileset of its own; give the size of a tile"):
        decode_tileset("a.ase", aseprite([[layer("pen"), cel(0, FLAT)]]), (4, 200))


def test_what_of_an_aseprite_file_cannot_be_shown_is_noted_and_the_rest_is_read() -> None:
    which = np.ones((2, 2), np.uint32)
    chunks = [
        *(tileset(FLAT[:4, :4], inside=False), layer("pen"), layer("ground", kind=2), layer("broken")),
        *(layer("shade", blend=1), cel(0, FLAT), tiles(1, which), chunk(0x2005, struct.pack("<H14x", 2))),
    ]
    found = decode("a.ase", aseprite([chunks]), (8, 8192), 64)
    assert np.array_equal(found.pixels[..., :3], FLAT[..., :3])
    layered = decode_layers("a.ase", aseprite([chunks]), (8, 8192))
    assert set(layered.notes.layers) == set(found.notes.layers)
    notes = [(each.name, each.reason) for each in found.notes.layers]
    assert sorted(notes) == [("broken", "damaged"), ("ground", "foreign"), ("shade", "effect")]
    assert "'ground': tileset in another file left out; convert it to a layer" in found.notes.text
    assert "'broken': cannot be read in frame 1" in found.notes.text
    assert "'shade': blend mode multiply shown as normal" in found.notes.text


def test_an_openraster_file_without_its_merged_picture_is_composed() -> None:
    stack = """<image w="120" h="80"><stack>
        <layer name="r" src="data/\u7dda.png" x="60" y="0" composite-op="svg:multiply"/>
        <layer name="l" src="data/l.png" opacity="1.0"/></stack></image>"""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        file.writestr("stack.xml", stack.encode())
        file.writestr("data/l.png", png(FLAT[:, :60]))
        file.writestr("data/\u7dda.png", png(FLAT[:, 60:]))
    # Some programs write such a name without the flag for Unicode, which is in both lists of names.
    content = out.getvalue()
    _, *places = [each.start() for each in re.finditer("data/\u7dda.png".encode(), content)]
    for place, back in zip(places, (30 - 7, 46 - 9), strict=True):
        assert content[place - back] == 0x08
        content = content[: place - back] + b"\0" + content[place - back + 1 :]
    found = decode("a.ora", content, (8, 8192), 64)
    assert np.array_equal(found.pixels, FLAT)
    assert found.notes.text == "'r': blend mode multiply shown as normal"
    assert [each.name for each in decode_layers("a.ora", content, (8, 8192)).layers] == ["l", "r"]


def krita(mask: str = "", other: str = "") -> bytes:
    """A Krita file of a layer of one tile, and of a mask whose left half is 0."""
    document = f"""<DOC xmlns="http://www.calligra.org/DTD/krita"><IMAGE width="64" height="64"><layers>
        {other}
        <layer nodetype="paintlayer" name="fox" filename="layer2" colorspacename="RGBA">{mask}</layer>
        </layers></IMAGE></DOC>"""
    half = np.full((64, 64), 255, np.uint8)
    half[:, :32] = 0
    files = {"layer2": np.full((64, 64, 4), (10, 20, 30, 255), np.uint8), "mask3.pixelselection": half}
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        file.writestr("maindoc.xml", document)
        for name, pixels in files.items():
            head = f"VERSION 2\nTILEWIDTH 64\nTILEHEIGHT 64\nPIXELSIZE {pixels.size // 4096}\nDATA 1\n"
            tile = b"\0" + pixels.tobytes()
            file.writestr(f"a/layers/{name}", f"{head}0,0,LZF,{len(tile)}\n".encode() + tile)
    return out.getvalue()


def test_transparency_masks_of_krita_are_applied_and_other_masks_noted() -> None:
    mask = '<mask nodetype="transparencymask" filename="mask3"/><mask nodetype="filtermask"/>'
    found = decode_layers("a.kra", krita(f"<masks>{mask}</masks>"), (8, 64))
    assert (found.layers[0].left, found.layers[0].pixels.shape) == (32, (64, 32, 4))
    assert found.layers[0].pixels[0, 0].tolist() == [30, 20, 10, 255]
    assert found.notes.text == "'fox': filter mask left out"
    assert np.array_equal(decode("a.kra", krita(), (8, 64), 64).pixels[0, 0], [30, 20, 10, 255])


def test_layers_of_krita_without_pixels_do_not_cost_the_others() -> None:
    others = (
        '<layer nodetype="shapelayer" name="form"/><layer nodetype="paintlayer" name="lost" filename="l9"/>'
    )
    found = decode_layers("a.kra", krita(other=others), (8, 64))
    assert [each.name for each in found.layers] == ["fox"]
    assert "'form': vector layer left out" in found.notes.text
    assert "'lost': cannot be read: is a ZIP without layers/l9" in found.notes.text


def test_a_file_of_no_possible_size_is_refused_before_more_of_it_is_read() -> None:
    broken = aseprite([[layer("a")]], size=(9000, 80))[:140]
    for read in (
        lambda: decode("a.ase", broken, (8, 8192), 64),
        lambda: decode_frames("a.ase", broken, (8, 8192)),
        lambda: decode_layers("a.ase", broken, (8, 8192)),
    ):
        with pytest.raises(InputError, match="is 9000 × 80 pixels; a drawing has 8 to 8192 a side"):
            read()
