"""Pages cut to their drawing, narrow as a banner or reduced to the size of a sprite."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pages import Floats, Page, page
from shapes import Rng, Shape

SIZES = (
    ((256, 256), 6), ((256, 192), 8), ((192, 256), 8), ((256, 128), 8), ((128, 256), 8), ((96, 256), 8),
    ((256, 96), 8), ((384, 384), 4), ((384, 256), 5), ((256, 384), 5), ((384, 160), 6), ((160, 384), 6),
    ((384, 96), 8), ((96, 384), 8),
)  # fmt: skip
"""Sizes of the network's input and the number of pages of a batch."""
MARGIN = 0.05
"""Largest margin around the drawing, as a fraction of its longer side."""
STRETCHED = 1.35
"""Largest stretch of one side by which a crop is brought to the ratio of sides that a batch has."""
SMALL = 48, 220
"""Longer sides of pictures that the reader has to enlarge."""
ENLARGED = 256
"""Longer side to which the reader enlarges a small picture, in pixels."""
KINDS = (
    "clean",
    "gaps",
    "sketchy",
    "coloured",
    "photo",
    "flat",
    "inverted",
    "several",
    "child",
    "silhouette",
)
SHARES = (0.2, 0.14, 0.06, 0.12, 0.06, 0.14, 0.06, 0.08, 0.1, 0.04)


def crop(rng: Rng, shapes: list[Shape], size: tuple[int, int]) -> Page:
    """Return a page of (H, W) pixels whose drawing fills it."""
    best, loss = None, np.inf
    canvas = max(size), max(size)
    like = [
        shape for shape in _some(rng, shapes, 200) if abs(np.log(_ratio(shape) * size[1] / size[0])) < 0.5
    ]
    for _ in range(3):
        drawn = page(rng, like or shapes, canvas, str(rng.choice(KINDS, p=SHARES)))
        box = _tight(drawn, rng)
        if box is None:
            continue
        wrong = abs(np.log((box[2] - box[0]) / (box[3] - box[1]) * size[1] / size[0]))
        if wrong < loss:
            best, loss = (drawn, box), wrong
        if loss < np.log(STRETCHED):
            break
    if best is None:
        return page(rng, shapes, size)
    return _resized(best[0], _widened(best[1], size), size, rng)


def _some(rng: Rng, shapes: list[Shape], count: int) -> list[Shape]:
    return [shapes[each] for each in rng.integers(len(shapes), size=count)] if shapes else []


def _ratio(shape: Shape) -> float:
    """Return the height of an object as a fraction of its width."""
    points = np.concatenate([each for group in shape.contours for each in group] + shape.bare)
    wide, high = np.maximum(np.ptp(points, axis=0), 1e-3)
    return float(high / wide)


def _tight(drawn: Page, rng: Rng) -> tuple[int, int, int, int] | None:
    """Return the top, left, bottom and right of a page's drawing; None if there is nearly nothing."""
    rows, columns = np.nonzero((drawn.presence > 0.5) | (drawn.ink > 0.5))
    if len(rows) < 200:
        return None
    margin = rng.uniform(0, MARGIN) if rng.random() < 0.85 else rng.uniform(0, 3 * MARGIN)
    space = round(margin * max(np.ptp(rows), np.ptp(columns))) + 1
    high, wide = drawn.presence.shape
    return (
        max(int(rows.min()) - space, 0), max(int(columns.min()) - space, 0),
        min(int(rows.max()) + 1 + space, high), min(int(columns.max()) + 1 + space, wide),
    )  # fmt: skip


def _widened(box: tuple[int, int, int, int], size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return a box that takes in as much more of the page as its ratio of sides lacks, up to a stretch."""
    canvas = max(size)
    top, left, bottom, right = box
    high, wide = bottom - top, right - left
    needed_high = round(wide * size[0] / size[1] / STRETCHED)
    needed_wide = round(high * size[1] / size[0] / STRETCHED)
    if needed_high > high:
        top = int(np.clip((top + bottom - needed_high) // 2, 0, max(canvas - needed_high, 0)))
        bottom = min(top + needed_high, canvas)
    if needed_wide > wide:
        left = int(np.clip((left + right - needed_wide) // 2, 0, max(canvas - needed_wide, 0)))
        right = min(left + needed_wide, canvas)
    return top, left, bottom, right


def _resized(drawn: Page, box: tuple[int, int, int, int], size: tuple[int, int], rng: Rng) -> Page:
    top, left, bottom, right = box
    rows, columns = slice(top, bottom), slice(left, right)
    picture: NDArray[Any] = drawn.picture[rows, columns]
    share = np.array(size) / picture.shape[:2]
    if max(size) == ENLARGED and rng.random() < 0.6:
        small = np.exp(rng.uniform(*np.log(SMALL))) / max(size)
        wanted = np.maximum(np.rint(np.array(size) * small), 8).astype(int)
        if (wanted < picture.shape[:2]).all():
            picture = cv2.resize(picture, wanted[::-1].tolist(), interpolation=cv2.INTER_AREA)

    def fit(values: Floats, method: int) -> Floats:
        part = np.asarray(values[rows, columns], np.float32)
        return np.asarray(cv2.resize(part, size[::-1], interpolation=method), np.float32)

    shrunk = cv2.INTER_AREA if (share < 1).all() else cv2.INTER_LINEAR
    # Offsets are shares of the longer side, which the canvas and the crop have in common.
    middle = np.stack(
        [fit(each, cv2.INTER_NEAREST) * by for each, by in zip(drawn.middle, share[::-1], strict=True)]
    )
    enlarged = picture.shape[0] < size[0]
    shown = cv2.resize(picture, size[::-1], interpolation=cv2.INTER_LINEAR if enlarged else cv2.INTER_AREA)
    return Page(
        np.asarray(shown, np.uint8),
        fit(drawn.ink, shrunk),
        fit(drawn.presence, shrunk),
        middle,
        fit(drawn.weight, cv2.INTER_LINEAR),
        fit(drawn.ink_weight, cv2.INTER_LINEAR),
        drawn.kind,
    )
