"""Painted areas: what is wide and dark in a drawing is no line: a coloured body, a desk around the sheet."""

from functools import reduce
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.histogram import Histogram

__all__ = [
    "darkest",
    "has_scenery",
    "lightest",
    "painted_areas",
    "paper_colour",
    "shadows",
    "steps",
    "surroundings",
    "wide_and_dark",
]

_PAINTED = 0.8
"""What is wide and darker than this share of the sheet, in its darkest channel, is painted or shaded."""
_STEP = 0.12
"""How much darker, as a share of the sheet, a painted area is than what lies a few pixels beside it."""
_ALIKE = 0.12
"""Colours that differ by no more in any channel are one paint."""
_EDGE = 0.05
"""Share of the picture's edge along which a dark area lies that may be a shadow on the sheet."""
_RATIO = 1.25
"""How many times as light it gets within a few pixels at the edge of a sheet on a desk, in a shadow too."""
_TINT = 0.06
"""How far the shares of the three channels in a colour are from those of the sheet where only light lacks."""
_DEEP = 0.02
"""How deep, as a share of the longest side, a line goes into both sides of an edge that it crosses."""
_PENUMBRA = 0.03
"""Width of the edge of a shadow at most, as a share of the longest side; a wider one is no sharp one."""
_LINE = 0.35
"""Share of the light of the paper about it that a line takes at least."""
_SATURATED = 0.3
"""How much less of one channel than of another a colour has that is no paper's, nor a lamp's on paper."""
_ALONG = 0.12
"""Share of the picture's edge that a painted ground takes up at least."""
_MOST = 12
"""Painted areas whose thin parts are looked for, the largest first."""


def darkest(colour: Floats) -> Floats:
    """Return the least channel of colours, (H, W); NumPy's own takes ten times as long."""
    return colour if colour.ndim == 2 else np.asarray(reduce(cv2.min, cv2.split(colour)), np.float32)


def lightest(colour: Floats) -> Floats:
    """Return the greatest channel of colours, (H, W), as `darkest` does the least."""
    return colour if colour.ndim == 2 else np.asarray(reduce(cv2.max, cv2.split(colour)), np.float32)


def paper_colour(paper: Floats) -> Floats:
    """Return the colour (C,) of the sheet, given that of the paper about each pixel, (H, W, 3) or (H, W)."""
    counted = [Histogram(np.asarray(channel, np.float32), 0, 1) for channel in cv2.split(paper)]
    level = np.array([each.quantile(0.5) for each in counted])
    lightest = np.array([each.quantile(0.95) for each in counted])
    # Where more than half is painted, the median is paint, in all channels: the sheet has one colour.
    painted = bool((level < 0.7 * lightest).any())
    return np.asarray(np.maximum(lightest if painted else level, 0.04), np.float32)


def wide_and_dark(paper: Floats, level: Floats) -> BoolMask:
    """Return where a drawing may be painted or shaded, (H, W).

    Args:
        paper: (H, W, 3), the lightest colour about each pixel; (H, W) if it is grey.
        level: (3,) or (1,), the sheet's colour.
    """
    wide: BoolMask = darkest(np.asarray(paper / level, np.float32)) < _PAINTED
    return wide


def steps(darkness: Floats) -> BoolMask:
    """Return where a picture (H, W) gets darker within a few pixels; at a shadow's edge it takes more."""
    square = np.ones((7, 7), np.uint8)
    found: BoolMask = cv2.dilate(darkness, square) - cv2.erode(darkness, square) > _STEP
    return found


def shadows(colour: Floats, paper: Floats, level: Floats) -> BoolMask:
    """Return where the sheet lies in a shadow that reaches the picture's edge, (H, W).

    Such a shadow is wide and dark as a desk is. But it has the sheet's tint, and it either begins softly or
    has lines that go on from the light into it, which a desk has not. Where sheet and desk lie in one
    shadow, the sheet's edge tells them apart.

    Args:
        colour: (H, W, 3), the drawing; (H, W) if it is grey.
        paper: of the same shape, the lightest colour about each pixel.
        level: (3,) or (1,), the sheet's colour.
    """
    relative = np.asarray(paper / level, np.float32)
    darkness = darkest(relative)
    wide: BoolMask = darkness < _PAINTED
    found = np.zeros_like(wide)
    if not _along_edge(wide, _EDGE).any():
        return found
    square = np.ones((7, 7), np.uint8)
    sharp: BoolMask = cv2.dilate(darkness, square) > _RATIO * cv2.erode(darkness, square)
    if relative.ndim == 3:
        shares = relative / np.maximum(relative.sum(-1, keepdims=True), 1e-3)
        sheet = wide & (lightest(np.abs(shares - np.float32(1 / 3))) < _TINT)
    else:
        sheet = wide
    even = wide & ~sharp
    # Without their rims: at a corner, the lit desk may be as dark as the sheet in its shadow.
    core = cv2.erode((even & sheet).astype(np.uint8), square)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(core, connectivity=4)
    largest = 1 + np.argsort(-stats[1:, cv2.CC_STAT_AREA], kind="stable")[:_MOST]
    deep = _DEEP * max(wide.shape)
    ink = darkest(np.asarray(colour / np.maximum(paper, 1e-3), np.float32)) < 1 - _LINE
    numbered = cv2.connectedComponents(ink.astype(np.uint8), connectivity=8)[1]
    lines = np.asarray(numbered, np.int32)
    lit = ~wide
    beside = wide & (cv2.dilate(lit.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)
    for label in largest[stats[largest, cv2.CC_STAT_AREA] > deep * deep]:
        own = (cv2.dilate((labels == label).astype(np.uint8), square) > 0) & even
        about = cv2.dilate(own.astype(np.uint8), square) > 0
        rim = about & beside
        soft = rim.sum() > deep and sharp[rim].mean() < 0.3
        if soft or _crossed(lines, own, lit | found, deep):
            found |= about & sheet
    # The edge of a shadow, which is sharp, belongs to it; that of the sheet belongs to the desk.
    width = 2 * round(_PENUMBRA * max(wide.shape)) + 1
    near = cv2.dilate(found.astype(np.uint8), np.ones((width, width), np.uint8)) > 0
    desk = cv2.erode((even & ~found).astype(np.uint8), square)
    desk = cv2.dilate(desk, np.ones((15, 15), np.uint8))
    whole: BoolMask = found | (near & sheet & sharp & (desk == 0))
    return whole


def _crossed(lines: NDArray[np.int32], own: BoolMask, other: BoolMask, deep: float) -> bool:
    """Return whether a line, of those that are numbered (H, W), lies deep in both of two areas."""
    inner, outer = (
        np.unique(lines[cv2.distanceTransform(each.astype(np.uint8), cv2.DIST_L2, 3) > deep])
        for each in (own, other)
    )
    return len(np.intersect1d(inner, outer)) > 1  # beside 0, which is no line


def painted_areas(
    colour: Floats, paper: Floats, level: Floats, step: BoolMask, shadow: BoolMask
) -> tuple[BoolMask, Floats]:
    """Return where a drawing is painted, (H, W), and the paper with painted areas as wide as they are.

    The paper is found by a window, so that of a painted body the window shows the trunk and not the legs,
    which are narrower. What hangs together with the trunk and has its colour belongs to it.

    Args:
        colour: (H, W, 3), the drawing; (H, W) if it is grey.
        paper: of the same shape, the lightest colour about each pixel.
        level: (3,) or (1,), the sheet's colour.
        step: (H, W), where it gets darker within a few pixels.
        shadow: (H, W), where the sheet lies in a shadow, and is not painted.
    """
    wide = wide_and_dark(paper, level) & ~shadow
    if not wide.any():
        return wide, paper
    painted, paper = np.zeros_like(wide), paper.copy()
    _, labels, stats, _ = cv2.connectedComponentsWithStats(wide.astype(np.uint8), connectivity=4)
    largest = 1 + np.argsort(-stats[1:, cv2.CC_STAT_AREA], kind="stable")[:_MOST]
    for label in largest[stats[largest, cv2.CC_STAT_AREA] > 16]:
        own = labels == label
        edge = own & (cv2.erode(own.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1) == 0)
        if edge.any() and step[edge].mean() < 0.5:
            continue  # shaded
        paint = np.median(colour[own], axis=0)
        alike = (lightest(np.abs(colour - paint)) < _ALIKE) & (darkest(colour / level) < _PAINTED) & ~shadow
        _, parts = cv2.connectedComponents((alike | own).astype(np.uint8), connectivity=4)
        parts_of_it = parts == np.bincount(parts[own]).argmax()
        same = parts_of_it & alike  # at the window's edges the trunk's paper is too light as well
        paper[same] = np.minimum(paper[same], np.maximum(paint, colour[same]))
        painted |= parts_of_it
    return painted, paper


def surroundings(painted: BoolMask) -> BoolMask:
    """Return the painted areas (H, W) that take up much of the picture's edge, such as a desk."""
    return _along_edge(painted, 0.2)


def has_scenery(paper: Floats, level: Floats) -> bool:
    """Return whether a picture's ground is painted in several colours, as a landscape is.

    A sheet has one, and so has a desk around it: along the picture's edge there are at most two, one of which
    is the sheet's and hardly saturated.

    Args:
        paper: (H, W, 3), the lightest colour about each pixel; (H, W) if the picture is grey.
        level: (3,) or (1,), the sheet's colour.
    """
    if paper.ndim == 2:
        return False
    edge = _edge(paper)
    shares = edge / np.maximum(edge.sum(-1, keepdims=True), 1e-3)
    tint = level / level.sum()
    # Of dark colours light tells nothing: their tint is noise.
    other = (np.abs(shares - tint).max(-1) > _TINT) & (edge.max(-1) > 0.15)
    kinds = 0
    for _ in range(3):
        if other.mean() < _ALONG:
            break
        middle = np.median(shares[other], axis=0)
        # Of many colours the median is none: the one that is next to it is.
        middle = shares[other][np.abs(shares[other] - middle).sum(-1).argmin()]
        alike = other & (np.abs(shares - middle).max(-1) < _TINT)
        kinds += int(alike.mean() >= _ALONG)
        other &= ~alike
    saturated = 1 - level.min() / level.max() > _SATURATED
    return kinds + int(saturated) >= 2


def _along_edge(areas: BoolMask, share: float) -> BoolMask:
    """Return those connected areas (H, W) that take up more than a share of the picture's edge."""
    if _edge(areas).mean() <= share:  # of most drawings: all of them together take up too little of it
        return np.zeros_like(areas)
    count, labels = cv2.connectedComponents(areas.view(np.uint8), connectivity=4)
    edge = _edge(labels)
    around = np.bincount(edge, minlength=count) > share * len(edge)
    around[0] = False
    found: BoolMask = around[labels]
    return found


def _edge(picture: NDArray[Any]) -> NDArray[Any]:
    """Return the pixels along the edge of a picture (H, W, …), those at the corners twice."""
    return np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
