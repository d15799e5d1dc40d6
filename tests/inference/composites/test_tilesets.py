"""Tilesets: tiles that fit in the drawing fit in the map, whatever its colours and packing."""

import json
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from normalgan.__main__ import main
from normalgan.inference.composites.tile_grid import TileGrid, read_tiled
from normalgan.inference.composites.tilesets import predict_tileset
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.drawings import read_pixels

Pixels = NDArray[np.uint8]
T = TypeVar("T", bound=np.generic)
SIDE = 32
MEET = [
    ((0, 0), (0, 1), "right"),  # the left end of a platform and its middle
    ((0, 1), (0, 1), "right"),  # its middle repeats
    ((0, 1), (0, 2), "right"),
    ((0, 1), (1, 1), "below"),  # its grass and the earth below it
    ((1, 1), (1, 1), "below"),
    ((1, 1), (1, 1), "right"),
    ((1, 0), (1, 0), "below"),
    ((0, 3), (0, 3), "right"),  # bricks, beside what they do not fit
    ((0, 3), (0, 3), "below"),
]
"""Tiles by row and column that a level has side by side."""


def tileset() -> Pixels:
    """Return 3 × 3 tiles of a platform with stones that repeat, and in a column bricks, nothing, a ball."""
    earth = np.full((SIDE, SIDE, 4), (120, 80, 50, 255), np.uint8)
    for x, y, radius in ((8, 9, 4), (24, 20, 5), (31, 4, 3)):
        for right in (-SIDE, 0, SIDE):
            cv2.circle(earth, (x + right, y), radius, (60, 40, 25, 255), 1)
    platform = np.tile(earth, (3, 3, 1))
    platform[:6] = 80, 170, 60, 255
    platform[6] = 40, 90, 35, 255
    platform[[0, -1]] = platform[:, [0, -1]] = 25, 18, 15, 255
    bricks = np.full((SIDE, SIDE, 4), (170, 80, 60, 255), np.uint8)
    bricks[7::8] = bricks[:8, ::16] = bricks[8:16, 8::16] = 70, 40, 40, 255
    bricks[16:24, ::16] = bricks[24:, 8::16] = 70, 40, 40, 255
    ball = np.zeros((SIDE, SIDE, 4), np.uint8)
    cv2.circle(ball, (16, 16), 11, (220, 50, 40, 255), -1)
    cv2.circle(ball, (16, 16), 11, (40, 10, 10, 255), 2)
    return np.hstack([platform, np.vstack([bricks, np.zeros_like(bricks), ball])])


def spaced(packed: Pixels, margin: int, spacing: int) -> Pixels:
    rows, columns = packed.shape[0] // SIDE, packed.shape[1] // SIDE
    whole = np.zeros((rows * (SIDE + spacing) + margin, columns * (SIDE + spacing) + margin, 4), np.uint8)
    for row in range(rows):
        for column in range(columns):
            top, left = margin + row * (SIDE + spacing), margin + column * (SIDE + spacing)
            whole[top : top + SIDE, left : left + SIDE] = tile(packed, (row, column))
    return whole


def tile(picture: NDArray[T], place: tuple[int, int]) -> NDArray[T]:
    row, column = place
    return picture[row * SIDE :, column * SIDE :][:SIDE, :SIDE]


def generate(*arguments: str) -> int:
    return main(["generate", *arguments, "--model", "model.onnx"])


def pixels(path: str) -> Pixels:
    return np.asarray(Image.open(path))


@pytest.mark.parametrize(
    ("mode", "options"), [("RGBA", ()), ("L", ()), ("P", ("--detail", "0.5"))], ids=["RGBA", "L", "P detail"]
)
def test_tiles_that_fit_have_the_same_normals_where_they_meet(
    here: Path, mode: str, options: tuple[str, ...]
) -> None:
    picture = Image.fromarray(tileset())
    (picture if mode == "RGBA" else picture.convert("RGB").convert(mode)).save("tiles.png")
    assert generate("tiles.png", "--tileset", "32x32", *options) == 0
    found = pixels("normals/tiles_normal.png")[..., :3].astype(int)
    assert np.ptp(tile(found, (0, 1)), axis=(0, 1)).max() > 30
    # With details mortar is a groove at the edge, and its two sides differ.
    for one, other, way in MEET[:-2] if options else MEET:
        if way == "right":
            steps = tile(found, one)[:, -1] - tile(found, other)[:, 0]
        else:
            steps = tile(found, one)[-1] - tile(found, other)[0]
        # At the corners of tiles two ways are adjusted in turn.
        assert np.abs(steps[2:-2]).max() <= 3, (one, other, way)


def test_margin_and_spacing_change_nothing(here: Path) -> None:
    Image.fromarray(tileset()).save("packed.png")
    Image.fromarray(spaced(tileset(), 1, 2)).save("spaced.png")
    assert generate("packed.png", "--tileset", "32x32", "--alpha") == 0
    assert generate("spaced.png", "--tileset", "32x32,margin=1,spacing=2", "--alpha") == 0
    expected = pixels("normals/packed_normal.png")
    assert np.array_equal(expected[..., 3] > 127, tileset()[..., 3] > 127)
    found = pixels("normals/spaced_normal.png")
    whole = spaced(expected, 1, 2)
    there = whole[..., 3] > 0  # what is transparent is padded from what lies about it
    assert np.array_equal(found[there], whole[there])
    assert not found[..., 3][~there].any()


def test_a_repeating_tile_has_heights_that_repeat(model: Path, tmp_path: Path) -> None:
    Image.fromarray(tileset()).save(tmp_path / "tiles.png")
    predictor = Predictor(OnnxBackend(model, threads=1))
    sheet = read_pixels(tmp_path / "tiles.png")
    preds = predict_tileset(predictor, sheet, TileGrid(SIDE, SIDE), "tiles.png")
    assert [each.tile for each in preds.cells if each.left == 3 * SIDE and each.top == 0] == ["both"]
    bricks = tile(preds.height(), (0, 3))
    inside = np.abs(np.diff(bricks, axis=1)).max()
    assert np.abs(bricks[:, 0] - bricks[:, -1]).max() <= 1.5 * inside


TSX = """<?xml version="1.0" encoding="UTF-8"?>
<tileset version="1.10" name="earth" tilewidth="32" tileheight="32" spacing="2" margin="1" tilecount="12">
 <image source="../art/tiles.png" width="137" height="103"/>
</tileset>"""
TSJ = {
    **{"type": "tileset", "tilewidth": 32, "tileheight": 32, "margin": 1, "spacing": 2},
    **{"image": "tiles.png", "imagewidth": 137, "imageheight": 103},
}


@pytest.mark.parametrize(("name", "text"), [("tiles.tsx", TSX), ("tiles.tsj", json.dumps(TSJ))])
def test_a_tileset_of_tiled_says_where_the_tiles_are(here: Path, name: str, text: str) -> None:
    Path(name).write_text(text)
    assert read_tiled(Path(name)) == TileGrid(32, 32, 1, 2, (137, 103))
    Image.fromarray(spaced(tileset(), 1, 2)).save("tiles.png")
    assert generate("tiles.png", "--tileset", name) == 0
    assert generate("tiles.png", "--tileset", ".", "-o", "by_folder") == 0
    assert pixels("by_folder/tiles_normal.png").tolist() == pixels("normals/tiles_normal.png").tolist()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("16", "give width x height of a tile in pixels"),
        ("4x4", "a tile of 4 × 4 pixels is too small"),
        ("0x16", "a tile of 0 × 16 pixels is too small"),
        ("500x500", "has 0 tiles of 500 × 500"),
        ("map.tmx", "map.tmx is not a tileset of Tiled"),
        ("collection.tsx", "collection of pictures"),
        ("other.tsx", "is for a picture of 64 × 64 pixels, but tiles.png has 128 × 96"),
        ("broken.tsx", "broken XML"),
    ],
)
def test_what_is_no_tileset_is_refused(
    here: Path, capsys: pytest.CaptureFixture[str], given: str, words: str
) -> None:
    Image.fromarray(tileset()).save("tiles.png")
    Path("map.tmx").write_text("<map><tileset firstgid='1' source='tiles.tsx'/></map>")
    Path("collection.tsx").write_text("<tileset tilewidth='32' tileheight='32'><tile id='0'/></tileset>")
    Path("other.tsx").write_text(
        "<tileset tilewidth='32' tileheight='32'><image source='a.png' width='64' height='64'/></tileset>"
    )
    Path("broken.tsx").write_text("<tileset tilewidth='32'")
    assert generate("tiles.png", "--tileset", given) == 2
    assert words in capsys.readouterr().err
    assert not Path("normals").exists()
