"""Measures any line drawing by its pixels: ink, widths, bends, ends, junctions."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve, gaussian_filter1d, label
from skimage.morphology import skeletonize

from normalgan.arrays import BoolMask, Doubles

_AROUND = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]])
_INK = 0.4  # from this darkness on, a pixel counts as ink
_ENLARGEMENT = 3  # factor of the enlargement
_CHAIN_SMOOTHING = (
    2.0 * _ENLARGEMENT
)  # pixels: a chain of pixels turns in steps of 45°, but the line itself does not
_SHORTEST_CHAIN = 8 * _ENLARGEMENT  # pixels: a shorter chain has no meaningful curvature


@dataclass(frozen=True)
class Figures:
    """Figures of one drawing; the unit of length is the larger side of the drawn part.

    Args:
        density: share of the bounding box that is ink.
        width: mean width of the lines, ink over length, in thousandths of the unit.
        width_spread: the quartiles' distance over the median of the width along the lines.
        turning: radians per unit along the lines.
        corners: places where a line turns by more than 45° within a fifteenth of the unit, per unit.
        ends: number of open ends.
        ends_per_length: open ends per unit.
        junctions: number of places where lines meet or cross.
        length: length of all lines, in units.
    """

    density: float
    width: float
    width_spread: float
    turning: float
    corners: float
    ends: float
    ends_per_length: float
    junctions: float
    length: float


def measure(ink: NDArray[np.floating]) -> Figures:
    """Return the figures of a drawing (H, W) with ink 1, paper 0 and greys in between.

    It is enlarged first, because its greys locate the edges of lines more finely than whole pixels.

    Raises:
        ValueError: if there is no ink.
    """
    rows, columns = np.nonzero(ink > _INK)
    if not len(rows):
        raise ValueError("a drawing without ink has no figures")
    window = np.pad(ink.astype(np.float32), 2)[rows.min() : rows.max() + 5, columns.min() : columns.max() + 5]
    part = cv2.resize(window, None, fx=_ENLARGEMENT, fy=_ENLARGEMENT, interpolation=cv2.INTER_CUBIC) > _INK
    height, width = (side - 4 * _ENLARGEMENT for side in part.shape)
    unit = max(height, width)
    distance = cv2.distanceTransform(part.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE).astype(
        np.float32
    )
    bones = without_spurs(thinned(part), distance)
    widths = 2 * distance[bones]
    low, median, high = np.percentile(widths, [25, 50, 75])
    paths = [path for path in chains(bones) if len(path) >= _SHORTEST_CHAIN]
    length = bone_length(bones) / unit
    turns, run, corners = 0.0, 0.0, 0
    for path in paths:
        smooth = gaussian_filter1d(path.astype(np.float64), _CHAIN_SMOOTHING, axis=0, mode="nearest")
        turns += float(np.abs(_angles(smooth, 1)).sum())
        run += float(np.hypot(*np.diff(smooth, axis=0).T).sum()) / unit
        corners += _peaks(np.abs(_angles(smooth, max(2, unit // 30))))
    # Thinning splits a crossing into two forks, as far apart as the lines are wide.
    near = cv2.dilate(_junctions(bones).astype(np.uint8), np.ones((1 + 2 * round(median),) * 2, np.uint8))
    ends, junctions = _ends(bones).sum(), label(near)[1]
    return Figures(
        density=float(window.sum() * _ENLARGEMENT**2 / (height * width)),
        width=float(1000 * window.sum() * _ENLARGEMENT**2 / bone_length(bones) / unit),
        width_spread=float((high - low) / median),
        turning=turns / max(run, 1e-9),
        corners=corners / max(run, 1e-9),
        ends=float(ends),
        ends_per_length=float(ends / length),
        junctions=float(junctions),
        length=length,
    )


def chains(bones: BoolMask) -> list[NDArray[np.intp]]:
    """Return the pixels (P, 2), row and column, of each line of a skeleton between junctions, in order."""
    labels, count = label(bones & ~_junctions(bones), np.ones((3, 3)))
    found = np.argwhere(labels)
    order = np.argsort(labels[tuple(found.T)], kind="stable")
    sizes = np.bincount(labels[tuple(found.T)], minlength=count + 1)[1:]
    return [_walk(part) for part in np.split(found[order], np.cumsum(sizes)[:-1])] if count else []


def _walk(pixels: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the pixels of one line in order, starting at an end if it has one."""
    left = {(int(row), int(column)) for row, column in pixels}
    steps = [(0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)]  # straight ones first

    def near(pixel: tuple[int, int]) -> list[tuple[int, int]]:
        return [there for i, j in steps if (there := (pixel[0] + i, pixel[1] + j)) in left]

    at = min(left, key=lambda pixel: (len(near(pixel)), pixel))
    path = [at]
    left.remove(at)
    while onward := near(at):
        at = onward[0]
        path.append(at)
        left.remove(at)
    return np.array(path)


def thinned(ink: BoolMask) -> BoolMask:
    """Return the middle lines, a pixel wide."""
    bones: BoolMask = skeletonize(ink)
    return bones


def without_spurs(bones: BoolMask, distance: NDArray[np.float32]) -> BoolMask:
    """Return a skeleton without the spurs that thinning leaves on thick or rough lines.

    A spur runs from an end to a junction, and is no longer than the line is wide there.
    """
    junctions = cv2.dilate(_junctions(bones).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    kept = bones.copy()
    for path in chains(bones):
        rows, columns = path.T
        at_end, at_junction = _ends(bones)[rows, columns].any(), junctions[rows, columns].any()
        if at_end and at_junction and len(path) < 2 * distance[rows, columns].max() + 1:
            kept[rows, columns] = False
    return thinned(kept)


def bone_length(bones: BoolMask) -> float:
    """Return the length of a skeleton in pixels: steps between neighbours, no diagonal across a corner."""
    straight = (bones[1:] & bones[:-1]).sum() + (bones[:, 1:] & bones[:, :-1]).sum()
    a, b, c, d = bones[:-1, :-1], bones[:-1, 1:], bones[1:, :-1], bones[1:, 1:]
    diagonal = (a & d & ~b & ~c).sum() + (b & c & ~a & ~d).sum()
    return float(straight + np.sqrt(2) * diagonal)


def _ends(bones: BoolMask) -> BoolMask:
    ends: BoolMask = bones & (convolve(bones.astype(int), _AROUND, mode="constant") == 1)
    return ends


def _junctions(bones: BoolMask) -> BoolMask:
    """Return where three or more lines leave a pixel: skeleton and paper alternate that often around it."""
    padded = np.pad(bones, 1)
    height, width = bones.shape
    ring = [(0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0), (0, 0)]
    around = [padded[i : i + height, j : j + width] for i, j in ring]
    begins = sum(
        (~here & after).astype(int) for here, after in zip(around, around[1:] + around[:1], strict=True)
    )
    junctions: BoolMask = bones & (begins >= 3)
    return junctions


def _angles(path: Doubles, reach: int) -> Doubles:
    """Return the turn in radians at the points of a path that have neighbours ``reach`` away."""
    if len(path) <= 2 * reach:
        return np.zeros(0)
    before, after = path[reach:-reach] - path[: -2 * reach], path[2 * reach :] - path[reach:-reach]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    angles: Doubles = np.arctan2(cross, (before * after).sum(axis=1))
    return angles


def _peaks(angles: Doubles) -> int:
    """Return the number of runs of points that turn by more than 45°."""
    return int(label(angles > np.pi / 4)[1])
