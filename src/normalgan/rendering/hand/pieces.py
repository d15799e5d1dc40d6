"""Pieces: a person draws a long outline in several strokes, the big ones first."""

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.hand.curves import begin_at, piece, turning
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["cut", "in_order", "inside"]

_CORNER = 0.012  # of the side; distance over which a turn is measured
_SHORTEST = 0.04  # of the side; the pen is not lifted again sooner
_ANYWHERE = 0.02  # radians²: the weight of a straight piece, so that the pen is lifted there too, seldom
_LATER = 0.2  # an inner stroke is drawn together with outline strokes a fifth as long
_RIM = 0.012  # of the side; strokes this near the silhouette belong to the outline


def cut(stroke: Stroke, cuts: float, step: float, side: float, rng: np.random.Generator) -> list[Stroke]:
    """Cut a stroke into the pieces in which it is drawn, mostly where it turns.

    Args:
        stroke: with points ``step`` pixels apart.
        cuts: how many are expected on the length of a side.
        step: pixels.
        side: side of the frame in pixels.
        rng: source of randomness.
    """
    count = len(stroke.points)
    reach = max(1, round(_CORNER * side / step))
    weights = turning(stroke.points, reach, stroke.closed) ** 2 + _ANYWHERE
    chance = weights / weights.sum()
    if stroke.closed:  # it is closed, so it begins at a corner too
        stroke = begin_at(stroke, int(rng.choice(count, p=chance)) % (count - 1))
        chance = turning(stroke.points, reach) ** 2 + _ANYWHERE
        chance /= chance.sum()
    wanted = rng.poisson(cuts * (count - 1) * step / side)
    chosen = np.sort(rng.choice(count, size=wanted, p=chance))
    shortest = round(_SHORTEST * side / step)
    edges = [0]
    for place in chosen:
        if edges[-1] + shortest <= place <= count - 1 - shortest:
            edges.append(int(place))
    edges.append(count - 1)
    return [piece(stroke, start, stop + 1) for start, stop in pairwise(edges)]


def inside(strokes: Sequence[Stroke], maps: Maps) -> Doubles:
    """Return the share of each stroke that lies within the object, away from its silhouette."""
    height, width = maps.mask.shape
    deep = cv2.distanceTransform(maps.mask.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    deep = deep > max(1.5, _RIM * max(height, width))  # the outermost pixels belong to the outline
    shares = []
    for stroke in strokes:
        x, y = stroke.points.astype(int).T
        shares.append(deep[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].mean())
    return np.array(shares)


def in_order(strokes: Sequence[Stroke], interior: Doubles) -> tuple[list[Stroke], Doubles]:
    """Return strokes and shares in the order of drawing: the outline first, and the longest first."""
    lengths = np.array([stroke.length for stroke in strokes])
    order = np.argsort(-lengths * np.where(interior > 0.5, _LATER, 1), kind="stable")
    return [strokes[index] for index in order], interior[order]
