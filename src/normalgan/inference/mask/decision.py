"""Decision: find the object from the lines, the reader's presence and the user's flips, and explain it."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.findings import Finding
from normalgan.inference.mask.edge import snap
from normalgan.inference.mask.outline_mask import fill_outline
from normalgan.inference.mask.reader import Reading
from normalgan.inference.network.line_width import line_width
from normalgan.inference.reading.picture import fitted, resize

__all__ = ["CLOSED", "Decision", "decide"]

CLOSED = 0.8
"""Share of the ink that must enclose something for the outline to be believed."""
_SIDE = 512
"""Longest side at which areas are filled and voted on, and twice the shortest; the ink gives their edge."""
_OFF, _LEAST_OFF = 2.5, 2.0
"""How far the edge found at that size may be off, in its pixels; and at least, in pixels of the drawing."""
_INKED = 0.35
"""Least ink of a line."""
_HOLE, _PART = 0.3, 0.75
"""Mean presence below which a region is a hole; and above which an open one is object all over."""
_EYE = 0.004
"""Share of the object below which an enclosed region is an eye or a button, and never a hole."""
_ADDED = 0.6
"""Mean presence from which an enclosed region is object although no outline encloses it."""
_SURE, _SPECK = 0.72, 0.002
"""Least mean presence of an area that no outline encloses, and its least share of the object."""
_UNSURE = 0.15, 0.7, 0.02
"""Mean presence between which the reader is unsure of a region; and the least share of the object to warn."""
_OPEN = 0.2
"""Share of the object's longer side over which its edge may go without a line, before that is told."""
_REACH = 4
"""How far from an edge a line bounds it, in pixels of the vote."""
_NEAR = 0.01
"""How far from a region a point that flips it may lie, as a share of the longer side: on its line, say."""


@dataclass(frozen=True)
class Decision:
    """The object in a drawing, and how it was found; arrays are at the size of the vote.

    Args:
        ink: (h, w) in [0, 1], the lines.
        outline: (h, w), what the lines enclose, with small gaps closed.
        presence: (h, w) in [0, 1], of the reader; None if it was not asked.
        regions: (h, w), the number of the region between lines that each pixel lies in; 0 on lines.
        votes: (N,), the mean presence of each region; 1 if the reader was not asked.
        enclosed: (N,), whether lines enclose the region on all sides.
        small: (h, w), the object.
        mask: (H, W), the object at the drawing's size.
        coverage: (H, W) in [0, 1], how much of each pixel that is.
        closed: share of the lines that lie in or at the object.
        guessed: whether a wide gap was closed although the reader was not asked.
        by_lines: whether lines alone enclose most of what is drawn, without a wide gap.
        unsure: regions that may or may not be object, and edges without a line; places are in pixels of the
            ink as it was given.
    """

    ink: Floats
    outline: BoolMask
    presence: Floats | None
    regions: NDArray[np.int32]
    votes: Floats
    enclosed: BoolMask
    small: BoolMask
    mask: BoolMask
    coverage: Floats
    closed: float
    guessed: bool
    by_lines: bool
    unsure: tuple[Finding, ...]

    def explain(self) -> dict[str, NDArray[np.uint8]]:
        """Return each stage as a picture (h, w) or (h, w, 3) of uint8, RGB, by the stage's name."""
        stages: dict[str, NDArray[np.uint8]] = {"outline": np.where(self.outline, 255, 0).astype(np.uint8)}
        stages["regions"] = self._votes_picture()
        if self.presence is not None:
            stages["presence"] = np.rint(255 * self.presence).astype(np.uint8)
        return stages

    def _votes_picture(self) -> NDArray[np.uint8]:
        """Return enclosed regions from red (hole) to green (object), each with its vote in percent."""
        share = np.clip(self.votes, 0, 1)[:, None]
        colours = (1 - share) * np.array([230, 70, 60]) + share * np.array([90, 200, 90])
        colours[~self.enclosed] = 255
        colours[0] = 0
        picture = np.ascontiguousarray(colours[self.regions].astype(np.uint8))
        sizes = np.bincount(self.regions.ravel(), minlength=len(self.votes))
        for number in np.flatnonzero(self.enclosed & (sizes > 300)):
            column, row = _deepest(self.regions == number)
            where = column - 9, row + 4
            cv2.putText(picture, f"{100 * self.votes[number]:.0f}", where, 0, 0.35, (0, 0, 0), 1, cv2.LINE_AA)
        return picture


def decide(ink: Floats, reading: Reading | None, flips: Sequence[tuple[float, float]] = ()) -> Decision:
    """Return the object by the lines and the reader's presence.

    Each region that lines enclose is object or hole as a whole, by its mean presence. Where an outline is
    open, presence closes it. Without a reading, all that lines enclose is object.

    Args:
        ink: (H, W) in [0, 1], the lines.
        reading: of the picture; None leaves it to the lines.
        flips: x and y of points; the enclosed region at each becomes a hole, or object if it is a hole.

    Raises:
        InputError: if there is no enclosed region at a point.

    Example:
        >>> ink = np.zeros((64, 64), np.float32)
        >>> cv2.rectangle(ink, (8, 8), (56, 56), 1, 2) is cv2.rectangle(ink, (24, 24), (40, 40), 1, 2)
        True
        >>> [int(decide(ink, None, flips).mask[32, 32]) for flips in ((), ((32, 32),))]
        [1, 0]
    """
    shape = (ink.shape[0], ink.shape[1])
    # In a small drawing, lines are connected only between pixels.
    side = min(max(*shape, _SIDE // 2), _SIDE)
    size = shape if side == max(shape) else fitted(shape, side)
    small_ink = ink if size == shape else resize(ink, size)
    inked = small_ink > _INKED
    filled = fill_outline(inked)
    outline = filled.mask
    presence = None if reading is None else reading.presence_at(size)
    count, found, measured, _ = cv2.connectedComponentsWithStats((~inked).astype(np.uint8), connectivity=4)
    regions, stats = np.asarray(found, np.int32), np.asarray(measured, np.int32)
    sizes = np.maximum(stats[:, cv2.CC_STAT_AREA], 1)
    enclosed = _enclosed(stats, size)
    if presence is None:
        votes = np.ones(count, np.float32)
        small = outline
    else:
        summed = np.bincount(regions.ravel(), weights=presence.ravel(), minlength=count)
        votes = (summed / sizes).astype(np.float32)
        small = _voted(inked, regions, enclosed, outline, presence)
        if not small.any():
            small = outline
    total = int(np.count_nonzero(small))
    settled = np.zeros(count, bool)
    for x, y in flips:
        number = _region_at(x, y, shape, regions, enclosed)
        own = regions == number
        small = small & ~own if small[own].mean() > 0.5 else small | own
        settled[number] = True
    unsure: list[Finding] = []
    if presence is not None:
        unsure += _unsure(regions, votes, sizes, enclosed & ~settled, total, shape)
        unsure += _open(small, small_ink > _INKED / 2, shape)
    rough: BoolMask = small if size == shape else resize(_smooth(small), shape) > 0.5
    coverage = snap(rough, ink, max(_OFF * max(shape) / _SIDE, _LEAST_OFF))
    return Decision(
        ink=small_ink,
        outline=outline,
        presence=presence,
        regions=regions,
        votes=votes,
        enclosed=enclosed,
        small=small,
        mask=coverage > 0.5,
        coverage=coverage,
        closed=filled.closed if presence is None else _closed(inked, small),
        guessed=presence is None and filled.guessed,
        by_lines=filled.closed >= CLOSED and not filled.guessed,
        unsure=tuple(unsure),
    )


def _enclosed(stats: NDArray[np.int32], size: tuple[int, int]) -> BoolMask:
    """Return which regions do not reach the picture's edge; number 0 is the lines."""
    left, top = stats[:, cv2.CC_STAT_LEFT], stats[:, cv2.CC_STAT_TOP]
    right, bottom = left + stats[:, cv2.CC_STAT_WIDTH], top + stats[:, cv2.CC_STAT_HEIGHT]
    enclosed: BoolMask = (left > 0) & (top > 0) & (right < size[1]) & (bottom < size[0])
    enclosed[0] = False
    return enclosed


def _voted(
    inked: BoolMask, regions: NDArray[np.int32], enclosed: BoolMask, outline: BoolMask, presence: Floats
) -> BoolMask:
    """Return the object (h, w): the regions voted for, with the lines around them."""
    # A cell is a part of a region that the outline treats alike.
    count = len(enclosed)
    cells = np.where(inked, 0, 2 * regions + outline)
    size = np.bincount(cells.ravel(), minlength=2 * count)
    mean = np.bincount(cells.ravel(), weights=presence.ravel(), minlength=2 * count) / np.maximum(size, 1)
    within = np.arange(2 * count) % 2 == 1
    inside = np.repeat(enclosed, 2)
    kept = np.where(within, mean >= _HOLE, inside & (mean > _ADDED))
    kept |= within & inside & (size < _EYE * np.count_nonzero(outline))
    pixelwise = ~inside & (~within | (mean < _PART))
    kept[0] = pixelwise[0] = False
    mixed = pixelwise[cells]
    solid: BoolMask = np.where(mixed, presence > 0.5, kept[cells]) & ~inked
    if mixed.any():
        solid = _without_guesses(solid, outline, presence)
    reach = 2 * round(line_width(inked) + 1.5) + 1
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    near = cv2.dilate(solid.astype(np.uint8), disc) > 0
    lines = inked & ((outline & near) | (near & (presence > 0.15)) | (presence > 0.4))
    mask = solid | lines
    # Between a line and what it bounds there is no gap of a pixel.
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)) > 0
    mask |= closed & ((presence > 0.3) | outline) & ~(within & ~kept)[cells]
    return mask


def _without_guesses(solid: BoolMask, outline: BoolMask, presence: Floats) -> BoolMask:
    """Return the object without specks and unsure areas outside the outline."""
    added = solid & ~outline
    count, labels, stats, _ = cv2.connectedComponentsWithStats(added.astype(np.uint8), connectivity=4)
    area = stats[:, cv2.CC_STAT_AREA]
    sure = np.bincount(labels[added], weights=presence[added], minlength=count) >= _SURE * area
    kept = sure & (area >= _SPECK * max(int(np.count_nonzero(solid)), 1))
    kept[0] = True
    found: BoolMask = solid & kept[labels]
    return found


def _closed(inked: BoolMask, mask: BoolMask) -> float:
    """Return the share of lines in or at the object."""
    reach = 2 * round(line_width(inked) + 1.5) + 1
    near = cv2.dilate(mask.astype(np.uint8), np.ones((reach, reach), np.uint8)) > 0
    return float(np.count_nonzero(inked & near) / max(int(np.count_nonzero(inked)), 1))


def _region_at(
    x: float, y: float, shape: tuple[int, int], regions: NDArray[np.int32], enclosed: BoolMask
) -> int:
    """Return the number of the enclosed region at a point of the drawing, or of the nearest one."""
    height, width = regions.shape
    column, row = x * width / shape[1], y * height / shape[0]
    reach = int(_NEAR * max(height, width)) + 1
    top, left = max(int(row) - reach, 0), max(int(column) - reach, 0)
    part = regions[top : int(row) + reach + 1, left : int(column) + reach + 1]
    rows, columns = np.nonzero(enclosed[part])
    exact = 0 <= row < height and 0 <= column < width and regions[int(row), int(column)]
    if exact and not enclosed[exact]:
        rows = rows[:0]
    if not len(rows):
        raise InputError(
            f"no enclosed region lies at x {x:g}, y {y:g}; give a point inside closed lines (see --explain)."
        )
    away = np.hypot(rows + top - int(row), columns[: len(rows)] + left - int(column))
    nearest = int(away.argmin())
    return int(part[rows[nearest], columns[nearest]])


def _unsure(
    regions: NDArray[np.int32],
    votes: Floats,
    sizes: NDArray[np.int32],
    asked: BoolMask,
    total: int,
    shape: tuple[int, int],
) -> list[Finding]:
    """Return the finding about regions that the reader is unsure of, the largest first, if any."""
    low, high, share = _UNSURE
    doubtful = asked & (votes > low) & (votes < high) & (sizes > share * max(total, 1))
    numbers = np.flatnonzero(doubtful)
    if not len(numbers):
        return []
    scale = shape[1] / regions.shape[1]
    points = [_deepest(regions == number) for number in numbers[np.argsort(-sizes[numbers])]]
    return [Finding("regions", tuple((x * scale, y * scale) for x, y in points), len(numbers))]


def _open(small: BoolMask, inked: BoolMask, shape: tuple[int, int]) -> list[Finding]:
    """Return the finding about the longest part of an object's edge without a line, if it is long."""
    reach = np.ones((2 * _REACH + 1, 2 * _REACH + 1), np.uint8)
    # What the picture's border cuts off needs no line there.
    bounded = cv2.dilate(inked.astype(np.uint8), reach, borderValue=1)
    inner = cv2.erode(small.astype(np.uint8), np.ones((3, 3), np.uint8))
    free = (small & (inner == 0) & (bounded == 0)).astype(np.uint8)
    free[:_REACH] = free[-_REACH:] = 0
    free[:, :_REACH] = free[:, -_REACH:] = 0
    if not free.any():
        return []
    count, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=8)
    rows, columns = np.nonzero(small)
    if count < 2 or stats[1:, cv2.CC_STAT_AREA].max() < _OPEN * (max(np.ptp(rows), np.ptp(columns)) + 1):
        return []
    rows, columns = np.nonzero(labels == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax()))
    middle = int(np.hypot(rows - rows.mean(), columns - columns.mean()).argmin())
    scale = shape[1] / small.shape[1]
    return [Finding("edge", ((float(columns[middle] * scale), float(rows[middle] * scale)),))]


def _deepest(region: BoolMask) -> tuple[int, int]:
    """Return x and y of the pixel of a region that is farthest from its edge."""
    depth = cv2.distanceTransform(np.pad(region, 1).astype(np.uint8), cv2.DIST_L2, 3)[1:-1, 1:-1]
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    return int(column), int(row)


def _smooth(mask: BoolMask) -> Floats:
    return np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.8), np.float32)
