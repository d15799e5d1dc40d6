"""Makes a picture of tiled maps of textures, without and with --tile: tiles_picture.py FILE.

The drawings come from this file, and repeat: stones, scales and bricks.
"""

import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import Voronoi

from normalgan import Predictor, load
from normalgan.inference.network.tile import Tile
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb

SIDE, TIMES, GAP = 256, 3, 6
SHOWN = 300
"""Side in pixels of the visible part of the tiles."""
SUPERSAMPLING = 4  # pixels drawn per pixel along each side, so that lines have soft edges
Points = NDArray[np.float64]
Pixels = NDArray[np.uint8]


def drawn(lines: Iterable[Points], width: float = 2.5) -> Pixels:
    """Return lines (n, 2) in units of the tile as a drawing (SIDE, SIDE) that repeats."""
    canvas = np.zeros((SIDE * SUPERSAMPLING, SIDE * SUPERSAMPLING), np.uint8)
    shifts = [np.array([x, y]) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    placed = [
        np.rint((line + shift) * SIDE * SUPERSAMPLING * 16).astype(np.int32)
        for line in lines
        for shift in shifts
    ]
    cv2.polylines(canvas, placed, False, 255, round(width * SUPERSAMPLING), cv2.LINE_AA, 4)
    return np.asarray(255 - cv2.resize(canvas, (SIDE, SIDE), interpolation=cv2.INTER_AREA), np.uint8)


def stones(across: int = 5) -> Pixels:
    """Return rounded stones: the cells of evenly scattered points."""
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(np.arange(across), np.arange(across)), -1).reshape(-1, 2) + 0.5
    points = (grid + rng.uniform(-0.32, 0.32, grid.shape)) / across
    cells = Voronoi(np.concatenate([points, *(np.add(points, shift) for shift in _around())]))
    return drawn(_rounded(cells.vertices[cells.regions[cells.point_region[i]]]) for i in range(len(points)))


def scales(rows: int = 6, columns: int = 4) -> Pixels:
    """Return rows of scales, each of which hides part of the next row."""
    turn = np.linspace(0, np.pi, 40)
    one = np.stack([0.5 / columns * np.cos(turn), np.sin(turn) / rows], 1)
    return drawn(
        np.add(one, [(c + r % 2 / 2) / columns, r / rows]) for r in range(rows) for c in range(columns)
    )


def bricks(rows: int = 4, columns: int = 2) -> Pixels:
    """Return courses of bricks."""
    at = np.array([0.13, 0.07])
    beds = [np.array([[0, r / rows], [1, r / rows]]) for r in range(rows)]
    ends = [((c + r % 2 / 2) / columns, r) for r in range(rows) for c in range(columns)]
    return drawn(
        [each + at for each in [*beds, *(np.array([[x, r / rows], [x, (r + 1) / rows]]) for x, r in ends)]]
    )


def _around() -> Sequence[tuple[int, int]]:
    return [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]


def _rounded(corners: Points) -> Points:
    """Return a closed line inside a polygon, with its corners cut three times (Chaikin)."""
    middle = corners.mean(0)
    line = middle + 0.86 * (corners - middle)
    for _ in range(3):
        following = np.roll(line, -1, 0)
        line = np.stack([0.75 * line + 0.25 * following, 0.25 * line + 0.75 * following], 1).reshape(-1, 2)
    return np.concatenate([line, line[:1]])


def lit(predictor: Predictor, drawing: Pixels, tile: Tile | None) -> Pixels:
    """Return a map tiled in both directions, rendered as lit clay."""
    result = predictor(drawing, tile=tile)
    flat = np.array([0, 0, 1], np.float32)
    normals = np.where(result.mask[..., None], result.normal, flat)
    clay = to_srgb(shade(np.tile(normals, (TIMES, TIMES, 1)), lamp_direction(130, 40)))
    return np.asarray(cv2.resize(clay, (SHOWN, SHOWN), interpolation=cv2.INTER_AREA), np.uint8)


def picture(makers: Sequence[Callable[[], Pixels]]) -> Pixels:
    """Return a row for each texture: the drawing, its tiles without and with --tile."""
    predictor = load()
    rows = []
    for make in makers:
        drawing = make()
        tiles = cv2.cvtColor(np.tile(drawing, (TIMES, TIMES)), cv2.COLOR_GRAY2RGB)
        first = np.asarray(cv2.resize(tiles, (SHOWN, SHOWN), interpolation=cv2.INTER_AREA), np.uint8)
        row = [first, lit(predictor, drawing, None), lit(predictor, drawing, "both")]
        beside = np.full((SHOWN, GAP, 3), 255, np.uint8)
        rows += [np.concatenate([row[0], beside, row[1], beside, row[2]], 1)]
        rows += [np.full((GAP, rows[0].shape[1], 3), 255, np.uint8)]
    return np.concatenate(rows[:-1])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: tools/tiles_picture.py FILE")
    cv2.setNumThreads(1)
    path = Path(sys.argv[1])
    # WebP, like the other sheets of grey clay: the loss is invisible, and a PNG is five times as large.
    Image.fromarray(picture([stones, scales, bricks])).save(path, quality=80, method=6)
    print(path, f"{path.stat().st_size // 1024} kB")
