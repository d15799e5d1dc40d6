"""Paper: from colours to ink, whatever the paper's tint, shadows and grain and the pen's colour."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.cleaning.painted import (
    darkest,
    lightest,
    painted_areas,
    paper_colour,
    steps,
    wide_and_dark,
)
from normalgan.inference.histogram import Histogram
from normalgan.inference.reading.picture import fitted, resize
from normalgan.normals import strips

__all__ = ["ink_on_paper"]

_SIDE = 512
"""Longest side at which the paper is estimated; it has no finer structure."""
_WINDOW = 0.07
"""A share of the longest side: wider areas of one colour are paper, or painted areas, and no strokes."""
_DARKEST = 0.25
"""Paper and paint are taken for no darker than this share of the sheet."""


def ink_on_paper(colour: Floats) -> Floats:
    """Return the lines of a drawing with dark lines: (H, W) ink in [0, 1], paper 0, lines about 1.

    The lightest colour within a window of each pixel is its paper; the pixel is divided by it, channel by
    channel, and the darkest channel counts, so that a yellow pen draws too. Around areas that are painted
    in one colour a line is drawn where they have none. Marks no stronger than the paper's grain are left out.

    Args:
        colour: (H, W, 3) in [0, 1].
    """
    shape = (colour.shape[0], colour.shape[1])
    red, green, blue = cv2.split(colour)
    if (red == green).all() and (red == blue).all():  # as in most drawings: one channel says it all
        colour = np.asarray(red, np.float32)
    small = colour if max(shape) <= _SIDE else resize(colour, fitted(shape, _SIDE))
    paper = _paper(small)
    level = paper_colour(paper)
    painted = step = wide_and_dark(paper, level)
    if painted.any():  # in most drawings nothing is
        step = steps(darkest(small / level))
        painted, paper = painted_areas(small, paper, level, step)
    beside = _enlarged(paper, shape)
    ink = np.empty(shape, np.float32)
    for rows in strips(colour.shape):
        # Of a dark paint, a share would be mere noise.
        share = (beside[rows] - colour[rows]) / np.maximum(beside[rows], _DARKEST * level)
        ink[rows] = lightest(share)
    ink = _without_grain(np.clip(ink - Histogram(ink, -1, 1).quantile(0.5), 0, 1))
    if painted.any():
        ink = np.maximum(ink, resize(_rim(painted, step), shape).clip(0, 1))
    return np.asarray(ink, np.float32)


def _paper(colour: Floats) -> Floats:
    """Return the lightest colour about each pixel, of the same shape, with edges where they were."""
    width = 2 * max(round(_WINDOW * max(colour.shape[:2]) / 2), 2) + 1
    window = cv2.getStructuringElement(cv2.MORPH_RECT, (width, width))
    # Grain has bright grains; without them the paper is not taken for lighter than it is.
    smooth = cv2.GaussianBlur(colour, (3, 3), 0)
    return np.asarray(cv2.morphologyEx(smooth, cv2.MORPH_CLOSE, window), np.float32)


def _enlarged(paper: Floats, shape: tuple[int, int]) -> Floats:
    """Return the paper with (H, W) pixels: it is smooth, so that lines between the pixels do."""
    if paper.shape[:2] == shape:
        return paper
    return np.asarray(cv2.resize(paper, shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)


def _without_grain(ink: Floats) -> Floats:
    """Return ink with the paper's grain at 0 and the lines brought to 1."""
    levels = Histogram(ink, 0, 1)
    usual = levels.quantile(0.5, below=0.3)
    grain = 0.0 if np.isnan(usual) else 1.4826 * levels.spread(usual, below=0.3)
    least = max(4 * grain, 0.06)
    faintest = 2 * least if levels.count(2 * least) else least
    if not levels.count(faintest):
        return np.zeros_like(ink)
    # A pen's edge is pale and its middle dark: the darker half tells how dark it draws.
    dark = max(levels.quantile(0.7, above=faintest), 2 * least)
    return np.asarray(np.clip((ink - np.float32(least)) / np.float32(dark - least), 0, 1), np.float32)


def _rim(painted: BoolMask, step: BoolMask) -> Floats:
    """Return a line inside the edge of painted areas, some two pixels wide, where the edge is sharp."""
    inside = np.pad(painted.astype(np.uint8), 1, mode="edge")
    within = cv2.erode(inside, np.ones((5, 5), np.uint8))
    return np.where(step, (inside - within)[1:-1, 1:-1], 0).astype(np.float32)
