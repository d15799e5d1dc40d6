"""Decision: find the object from the lines, the reader's presence and the holes that the user marks."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.findings import Finding
from normalgan.inference.mask.edge import snap
from normalgan.inference.reading.picture import fitted, resize
from normalgan.inference.regions import INKED, depth_of, enclosed_by, extent_of

SIDE = 512
"""Longer side in pixels at which regions are voted on: at most this, and at least half of it."""
_OFF, _LEAST_OFF = 2.5, 2.0
"""Tolerance of the edge in pixels of the vote, and its minimum in pixels of the drawing."""
UNSURE_LOW, UNSURE_HIGH = 0.15, 0.7
"""Range of mean presence in which a region is ambiguous. The vote is decided at 0.5, so the warning
covers more votes for a hole than for the object."""
UNSURE_SHARE = 0.02
"""Minimum area of an ambiguous region for a warning, as a fraction of the object's area."""
OPEN = 0.2
"""Length of an edge without a line that is reported, as a fraction of the object's longer side."""
REACH = 4
"""Maximum distance between an edge and the line that bounds it, in pixels of the vote."""
_BESIDE = 0.01
"""Maximum distance of a hole's point from its region, as a fraction of the longer side, so that a point on
the outline works too."""


class NoRegionError(InputError):
    """Raised if no lines enclose a region at a point.

    Args:
        words: sentence that says so.
        x: column of the point.
        y: row of the point.
    """

    def __init__(self, words: str, x: float = 0.0, y: float = 0.0) -> None:
        self.x, self.y = x, y
        super().__init__(words)

    @classmethod
    def at(cls, x: float, y: float) -> "NoRegionError":
        """Return the error for a point."""
        words = (
            f"no enclosed region lies at x {x:g}, y {y:g}; give a point inside closed lines (see --explain)."
        )
        return cls(words, x, y)


@dataclass(frozen=True)
class Decision:
    """The object in a drawing, and how it was found; (h, w) is the size of the vote.

    Args:
        ink: (h, w) in [0, 1], the lines.
        presence: (h, w) in [0, 1], the reader's presence; None if the reader was not used.
        regions: (h, w), index of the region between lines that each pixel lies in; 0 on lines.
        votes: (N,), mean presence of each region.
        enclosed: (N,), whether lines enclose the region on all sides.
        voted: (h, w), the object.
        mask: (H, W), the object at the drawing's size.
        coverage: (H, W) in [0, 1], coverage of each pixel by the object.
        unsure: findings about ambiguous regions and edges without a line; places are in pixels (H, W).
    """

    ink: Floats
    presence: Floats | None
    regions: NDArray[np.int32]
    votes: Floats
    enclosed: BoolMask
    voted: BoolMask
    mask: BoolMask
    coverage: Floats
    unsure: tuple[Finding, ...]

    def explain(self) -> dict[str, NDArray[np.uint8]]:
        """Return a picture of each stage by name, (h, w) or (h, w, 3) RGB, uint8."""
        stages = {"regions": self._votes_picture()}
        if self.presence is not None:
            stages["presence"] = np.rint(255 * self.presence).astype(np.uint8)
        return stages

    def _votes_picture(self) -> NDArray[np.uint8]:
        """Return a picture of the enclosed regions from red (hole) to green (object), labelled in percent."""
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


def decide(ink: Floats, reading: Reading | None, holes: Sequence[tuple[float, float]] = ()) -> Decision:
    """Find the object from the lines and the reader's presence.

    A region that lines enclose is entirely object or entirely hole, depending on its mean presence. Where an
    outline is open, presence decides for each pixel. Without a reading, all enclosed regions are object.

    Args:
        ink: (H, W) in [0, 1], the lines.
        reading: the reader's output; None decides by the lines alone.
        holes: x and y of points whose enclosed regions change from object to hole, or from hole to object.

    Raises:
        NoRegionError: if a point lies in no enclosed region.

    Example:
        >>> ink = np.zeros((64, 64), np.float32)
        >>> cv2.rectangle(ink, (8, 8), (56, 56), 1, 2) is cv2.rectangle(ink, (24, 24), (40, 40), 1, 2)
        True
        >>> [int(decide(ink, None, holes).mask[32, 32]) for holes in ((), ((32, 32),))]
        [1, 0]
    """
    shape = (ink.shape[0], ink.shape[1])
    # A small drawing is enlarged, because its lines may only connect at a subpixel scale.
    side = min(max(*shape, SIDE // 2), SIDE)
    size = fitted(shape, side)
    small_ink = ink if size == shape else resize(ink, size)
    inked = small_ink > INKED
    read = None if reading is None else reading.presence_at(size)
    presence = (enclosed_by(inked) & ~inked).astype(np.float32) if read is None else read
    regions = _regions_of(inked, presence)
    settled = np.zeros_like(regions.enclosed) if read is None else _lone(regions, inked, presence)
    voted = _voted(regions, inked, presence, settled)
    for x, y in holes:
        number = _region_at(x, y, shape, regions)
        voted[regions.labels == number] ^= True
        settled[number] = True
    unsure: list[Finding] = []
    if read is not None:
        unsure += _unsure(regions, ~settled, int(np.count_nonzero(voted)), shape)
        unsure += _open(voted, small_ink > INKED / 2, shape)
    enlarged: BoolMask = voted if size == shape else resize(voted.astype(np.float32), shape) > 0.5
    coverage = snap(enlarged, ink, max(_OFF * max(shape) / SIDE, _LEAST_OFF))
    labels, _, votes, enclosed = regions
    mask = coverage > 0.5
    return Decision(small_ink, read, labels, votes, enclosed, voted, mask, coverage, tuple(unsure))


class _Regions(NamedTuple):
    """The regions between lines: (h, w) labels, and sizes in pixels, votes and enclosure (N,)."""

    labels: NDArray[np.int32]
    sizes: NDArray[np.int32]
    votes: Floats
    enclosed: BoolMask


def _regions_of(inked: BoolMask, presence: Floats) -> _Regions:
    count, found, measured, _ = cv2.connectedComponentsWithStats((~inked).astype(np.uint8), connectivity=4)
    labels, stats = np.asarray(found, np.int32), np.asarray(measured, np.int32)
    sizes = np.maximum(stats[:, cv2.CC_STAT_AREA], 1)
    summed = np.bincount(labels.ravel(), weights=presence.ravel(), minlength=count)
    return _Regions(labels, sizes, (summed / sizes).astype(np.float32), _enclosed(stats, inked.shape))


def _voted(regions: _Regions, inked: BoolMask, presence: Floats, solid: BoolMask) -> BoolMask:
    """Return the object (h, w) before the user's holes; all ``solid`` regions (N,) belong to it."""
    labels, _, votes, enclosed = regions
    filled = np.where(enclosed[labels], ((votes > 0.5) | solid)[labels], presence > 0.5) & ~inked
    voted = filled | (inked & (presence > 0.5))
    # A hole must be enclosed by lines, so other gaps in the object are filled.
    return np.asarray(voted | (enclosed_by(voted) & ~enclosed[labels] & ~inked))


def _enclosed(stats: NDArray[np.int32], size: tuple[int, ...]) -> BoolMask:
    """Return which regions do not touch the picture's edge; index 0, the lines, is False."""
    left, top = stats[:, cv2.CC_STAT_LEFT], stats[:, cv2.CC_STAT_TOP]
    right, bottom = left + stats[:, cv2.CC_STAT_WIDTH], top + stats[:, cv2.CC_STAT_HEIGHT]
    enclosed: BoolMask = (left > 0) & (top > 0) & (right < size[1]) & (bottom < size[0])
    enclosed[0] = False
    return enclosed


def _lone(regions: _Regions, inked: BoolMask, presence: Floats) -> BoolMask:
    """Return which region (N,) is the object although the reader is unsure of it, such as a small circle.

    It is the only one that lines enclose, and no object is seen off the lines: if it were a hole, nothing
    would be left but its outline.
    """
    labels, sizes, votes, enclosed = regions
    elsewhere = int(np.count_nonzero((presence > 0.5) & ~inked & ~enclosed[labels]))
    least = UNSURE_SHARE * sizes[enclosed].max(initial=0)
    # Specks between lines are not regions that anybody drew.
    large: BoolMask = enclosed & (sizes > least)
    if np.count_nonzero(large) != 1 or elsewhere > least:
        return np.zeros_like(large)
    return large & (votes > UNSURE_LOW) & (votes < UNSURE_HIGH)


def _region_at(x: float, y: float, shape: tuple[int, int], found: _Regions) -> int:
    """Return the index of the enclosed region at a point of the drawing, or of the nearest one."""
    regions, enclosed = found.labels, found.enclosed
    height, width = regions.shape
    column, row = x * width / shape[1], y * height / shape[0]
    inside = 0 <= row < height and 0 <= column < width
    number = int(regions[int(row), int(column)]) if inside else 0
    if enclosed[number]:  # never index 0, the lines
        return number
    reach = int(_BESIDE * max(height, width)) + 1
    top, left = max(int(row) - reach, 0), max(int(column) - reach, 0)
    part = regions[top : int(row) + reach + 1, left : int(column) + reach + 1]
    rows, columns = np.nonzero(enclosed[part])
    # Only a point on a line or off the picture stands for a region beside it.
    if number or not len(rows):
        raise NoRegionError.at(x, y)
    away = np.hypot(rows + top - int(row), columns + left - int(column))
    nearest = int(away.argmin())
    return int(part[rows[nearest], columns[nearest]])


def _unsure(regions: _Regions, undecided: BoolMask, total: int, shape: tuple[int, int]) -> list[Finding]:
    """Return the finding about ambiguous regions, the largest first; empty if there are none."""
    labels, sizes, votes, enclosed = regions
    ambiguous = (votes > UNSURE_LOW) & (votes < UNSURE_HIGH)
    numbers = np.flatnonzero(enclosed & undecided & ambiguous & (sizes > UNSURE_SHARE * max(total, 1)))
    if not len(numbers):
        return []
    scale = shape[1] / labels.shape[1]
    points = [_deepest(labels == number) for number in numbers[np.argsort(-sizes[numbers])]]
    return [Finding("regions", tuple((x * scale, y * scale) for x, y in points), len(numbers))]


def _open(voted: BoolMask, inked: BoolMask, shape: tuple[int, int]) -> list[Finding]:
    """Return the finding about the longest part of the object's edge without a line; empty if it is short."""
    reach = np.ones((2 * REACH + 1, 2 * REACH + 1), np.uint8)
    # An object that the picture's border cuts off does not need a line there.
    bounded = cv2.dilate(inked.astype(np.uint8), reach, borderValue=1)
    inner = cv2.erode(voted.astype(np.uint8), np.ones((3, 3), np.uint8))
    free = (voted & (inner == 0) & (bounded == 0)).astype(np.uint8)
    free[:REACH] = free[-REACH:] = 0
    free[:, :REACH] = free[:, -REACH:] = 0
    if not free.any():
        return []
    _, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=8)
    if stats[1:, cv2.CC_STAT_AREA].max() < OPEN * extent_of(voted):
        return []
    rows, columns = np.nonzero(labels == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax()))
    middle = int(np.hypot(rows - rows.mean(), columns - columns.mean()).argmin())
    scale = shape[1] / voted.shape[1]
    return [Finding("edge", ((float(columns[middle] * scale), float(rows[middle] * scale)),))]


def _deepest(region: BoolMask) -> tuple[int, int]:
    """Return x and y of the pixel of a region that is farthest from the region's edge."""
    depth = depth_of(region, 3)
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    return int(column), int(row)
