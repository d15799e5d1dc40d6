"""Measures the value of the reader's lines: the error of the predicted normals by way of drawing.

grounds.py VIEWS [--count 36] [--side 400] [--sheet OUT.png]

It takes objects in VIEWS that the reader was not trained on, and draws each in fourteen ways: in pen or
pencil, painted with and without an outline, and on plain, dark, ruled, coloured or transparent grounds. The
error counts where the object certainly is; a pixel outside the predicted mask counts as 90°.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from shapes import Points, Rng, Shape, Views

import normalgan
from normalgan.errors import InputError

Floats = NDArray[np.float32]
MARGIN = 0.1
"""Margin around an object, as a share of the side."""
WHITE, BLACK, MAGENTA = ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 1.0))


def plane(lines: Sequence[Points], side: int, width: int | None) -> Floats:
    """Return lines of a width, or the area that they enclose if it is None, (S, S, 1) in [0, 1]."""
    drawn = np.zeros((side, side), np.uint8)
    points = [np.rint((line * (1 - 2 * MARGIN) + MARGIN) * side * 16).astype(np.int32) for line in lines]
    if width is None:
        cv2.fillPoly(drawn, points, (255,), cv2.LINE_AA, 4)
    else:
        for line in points:
            cv2.polylines(drawn, [line], False, (255,), width, cv2.LINE_AA, 4)
    return np.asarray(drawn[..., None] / 255, np.float32)


def drawings(shape: Shape, side: int, rng: Rng) -> tuple[dict[str, Floats], NDArray[np.bool_]]:
    """Return an object drawn in every way, (S, S, 3 or 4) in [0, 1], and its mask (S, S)."""
    ink = plane(shape.strokes, side, int(rng.integers(2, 5)))
    body = np.max([plane(group, side, None) for group in shape.contours], axis=0)
    light, dark = rng.uniform(0.3, 1, 3), rng.uniform(0, 0.45, 3)

    def painted(paint: object, ground: object = WHITE, pen: object = 0.0, lines: float = 1) -> Floats:
        page = np.asarray(ground) * (1 - body) + np.asarray(paint) * body
        return np.asarray(page * (1 - ink * lines) + np.asarray(pen) * ink * lines, np.float32)

    def grain(strength: float, size: float) -> Floats:
        noise = cv2.GaussianBlur(rng.normal(0, 1, (side, side)), (0, 0), size)
        return np.asarray(noise * size * strength, np.float32)[..., None]

    y, x = np.mgrid[:side, :side] / np.float32(side)
    paper = (0.95 - 0.45 * x - 0.1 * y)[..., None] * np.array([0.98, 0.95, 0.85])
    ruled = np.ones((side, side, 3))
    ruled[12::22] = 0.6, 0.7, 0.95
    clean = painted(WHITE)
    return {
        "pen": clean,
        "pencil": np.clip(painted(0.93, np.full(3, 0.93), 0.6) + grain(0.015, 0.7), 0, 1),
        "photo": np.clip(painted(paper, paper, 0.35 * paper) + grain(0.01, 0.7) + grain(0.01, 20), 0, 1),
        "ruled paper": painted(ruled, ruled, 0.1),
        "light on dark": 1 - clean,
        "lines on nothing": np.dstack([np.zeros_like(clean), ink]),
        "coloured": painted(light),
        "coloured dark": painted(dark),
        "coloured on black": painted(light, BLACK),
        "coloured on magenta": painted(light, MAGENTA, 0.1),
        "sprite": np.dstack([painted(light), body]),
        "no outline": painted(light, lines=0),
        "no outline, dark": painted(dark, lines=0),
        "no outline, on black": painted(light, BLACK, lines=0),
    }, body[..., 0] > 0.5


def truth_of(normal: Floats, side: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return an object's normals (S, S, 3), and where they are known (S, S)."""
    scale = (1 - 2 * MARGIN) * side / normal.shape[0]
    move = np.array([[scale, 0, MARGIN * side], [0, scale, MARGIN * side]], np.float32)
    placed = np.asarray(cv2.warpAffine(normal, move, (side, side)), np.float32)
    length = np.linalg.norm(placed, axis=-1)
    return placed / np.maximum(length, 1e-6)[..., None], length > 0.9


def over_white(picture: Floats) -> Floats:
    """Return a transparent picture (S, S, 4) composited over white, (S, S, 3)."""
    return np.asarray(picture[..., :3] * picture[..., 3:] + 1 - picture[..., 3:], np.float32)


def main() -> None:
    """Measure the shipped models."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("views", type=Path)
    parser.add_argument("--count", type=int, default=36)
    parser.add_argument("--side", type=int, default=400)
    parser.add_argument("--sheet", type=Path, help="a picture of the first object in each way")
    given = parser.parse_args()
    rng = np.random.default_rng(2)
    shapes = [shape for shape in Views(given.views, held_out=True).shapes if shape.normal is not None]
    model = normalgan.load("shipped")
    errors: dict[str, list[float]] = {}
    for number in rng.permutation(len(shapes))[: given.count]:
        drawn, body = drawings(shapes[number], given.side, rng)
        truth, known = truth_of(np.asarray(shapes[number].normal), given.side)
        known &= cv2.erode(body.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
        if given.sheet and not errors:
            flat = [each if each.shape[2] == 3 else over_white(each) for each in drawn.values()]
            sheet = np.vstack([np.hstack(flat[:7]), np.hstack(flat[7:])])
            cv2.imwrite(str(given.sheet), np.rint(255 * sheet[..., ::-1]).astype(np.uint8))
        for name, picture in drawn.items():
            try:
                found = model(np.rint(255 * picture).astype(np.uint8))
            except InputError:
                errors.setdefault(name, []).append(90.0)
                continue
            angle = np.degrees(np.arccos(np.clip((found.extended * truth).sum(-1), -1, 1)))
            errors.setdefault(name, []).append(float(np.where(found.mask, angle, 90)[known].mean()))
    for name, each in errors.items():
        print(f"{name:20} {np.mean(each):.2f}° (median {np.median(each):.2f}°, {len(each)} objects)")
    print(f"{'mean':20} {np.mean(list(errors.values())):.2f}°")


if __name__ == "__main__":
    main()
