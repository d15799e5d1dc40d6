"""Measures how much a map changes where the drawing does not, after a shift by a pixel or a stroke far away.

steadiness.py DRAWINGS… [--sides 256 1024] [--model FILE] [--picture FILE]

The drawings are files or patterns. Each is predicted unchanged, shifted on its paper by a pixel to the right,
down and both, and with a short stroke in the emptiest place of the object. Prints JSON: the mean change of
the normals in degrees where both maps have an object. For the stroke, only pixels farther from it than a
quarter of the drawing count.
"""

import argparse
import glob
import json
from pathlib import Path

import cv2
import numpy as np
from machine import describe
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.picture import fitted, read_picture
from normalgan.normals import angles, encode, paint_flat
from normalgan.weights.shipped import find_model

MOVES = {"right": (1, 0), "down": (0, 1), "both": (1, 1)}
STROKE, WIDTH, FAR = 1 / 12, 1 / 170, 1 / 4
"""Shares of the longer side: the stroke's length and width, and the distance from which a pixel is far."""
MARGIN = 8
"""Pixels of paper added around a drawing, so that it can be shifted."""


def drawn(path: Path, side: int) -> NDArray[np.uint8]:
    """Return a drawing on white paper, (H, W, 3), with room around it."""
    picture = read_picture(path)
    picture = picture.resized(fitted(picture.size, side - 2 * MARGIN))
    colour = picture.colour if picture.alpha is None else 1 - (1 - picture.colour) * picture.alpha[..., None]
    wide = ((MARGIN, MARGIN), (MARGIN, MARGIN), (0, 0))
    return np.pad(np.rint(255 * colour).astype(np.uint8), wide, constant_values=255)


def with_stroke(paper: NDArray[np.uint8], mask: NDArray[np.bool_]) -> tuple[NDArray[np.uint8], Floats]:
    """Return a drawing with a stroke where the object has most room, and each pixel's distance from it."""
    ink = paper.min(-1) < 128
    room = cv2.distanceTransform((mask & ~ink).astype(np.uint8), cv2.DIST_L2, 5)
    row, column = np.unravel_index(int(room.argmax()), room.shape)
    side = max(paper.shape)
    half = round(STROKE * side / 2)
    line = np.full(paper.shape[:2], 255, np.uint8)
    width = max(round(WIDTH * side), 1)
    cv2.line(line, (int(column) - half, int(row)), (int(column) + half, int(row)), 0, width, cv2.LINE_AA)
    away = cv2.distanceTransform((line > 128).astype(np.uint8), cv2.DIST_L2, 5)
    return np.minimum(paper, line[..., None]), np.asarray(away, np.float32)


def change(
    one: NormalMap, other: NormalMap, shift: tuple[int, int] = (0, 0)
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the change of each normal in degrees, (H, W), and where both maps have an object."""
    right, down = shift
    back = (-down, -right)
    moved = np.roll(other.extended, back, (0, 1))
    return angles(one.extended, moved), one.mask & np.roll(other.mask, back, (0, 1))


def measure(predictor: Predictor, paper: NDArray[np.uint8]) -> tuple[dict[str, float], list[NormalMap]]:
    """Return the mean changes of one drawing, and its maps without and with the stroke."""
    first = predictor(paper)
    found = {}
    for name, (right, down) in MOVES.items():
        moved = np.roll(paper, (down, right), (0, 1))
        turned, both = change(first, predictor(moved), (right, down))
        found[name] = float(turned[both].mean())
    marked, away = with_stroke(paper, first.mask)
    second = predictor(marked)
    turned, both = change(first, second)
    far = both & (away > FAR * max(paper.shape))
    found["stroke"] = float(turned[far].mean()) if far.any() else float("nan")
    return found, [first, second]


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("drawings", nargs="+")
    parser.add_argument("--sides", type=int, nargs="+", default=[256, 1024])
    parser.add_argument("--model", type=Path)
    parser.add_argument("--picture", type=Path, help="picture of each map, with that of the stroke below it")
    given = parser.parse_args()
    predictor = Predictor(OnnxBackend(find_model(given.model), threads=1))
    paths = sorted(Path(path) for pattern in given.drawings for path in glob.glob(pattern))
    report: dict[str, object] = {"drawings": len(paths)}
    columns = []
    for side in given.sides:
        each: dict[str, dict[str, float]] = {}
        for path in paths:
            try:
                each[path.stem], maps = measure(predictor, drawn(path, side))
            except InputError as error:
                raise SystemExit(f"{path}: {error}") from None
            if side == given.sides[0]:
                colours = [encode(paint_flat(one.extended, one.mask)) for one in maps]
                columns.append(cv2.resize(np.vstack(colours), (256, 512), interpolation=cv2.INTER_AREA))
        found = {name: [one[name] for one in each.values()] for name in (*MOVES, "stroke")}
        means, most = (
            {name: round(float(of(values)), 2) for name, values in found.items()}
            for of in (np.nanmean, np.nanmax)
        )
        report[str(side)] = {"mean": means, "most": most, "each": each}
    if given.picture:
        Image.fromarray(np.hstack(columns)).save(given.picture)
    print(json.dumps({**report, "machine": describe("numpy", "onnxruntime")}, indent=1))


if __name__ == "__main__":
    main()
