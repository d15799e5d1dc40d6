"""Composition: composites the maps of parts that were predicted separately."""

import math
from collections.abc import Sequence

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.vectors import unit

__all__ = ["compose", "tiled"]

_THIN = np.float32(1 / 255)
"""Opacity of what is too thin for the soft edge to leave any of it."""


def compose(maps: Sequence[NormalMap]) -> NormalMap:
    """Return one map of several parts of a drawing.

    A part hides the parts behind it. Along its soft edge, and where it is translucent, its normals are
    averaged with those behind, weighted by visibility (Porter and Duff's "over", 1984). Off all parts the
    normals are extended from the nearest part, so that edges keep their normals.

    Args:
        maps: maps of the same size (H, W), back to front; a single one is returned unchanged.

    Raises:
        ValueError: if there are none, or their sizes differ.
    """
    if not maps or len({each.mask.shape for each in maps}) > 1:
        raise ValueError(
            f"composited maps need the same size; these are {[each.mask.shape for each in maps]}"
        )
    if len(maps) == 1:
        return maps[0]
    normals, alpha, mask = maps[0].extended.copy(), maps[0].alpha, maps[0].mask.copy()
    confidence, seen = maps[0].confidence, _opacity(maps[0])
    for front in maps[1:]:
        over = _opacity(front)
        alone = (over > 0) & ((over >= 1) | (seen <= 0))
        np.copyto(normals, front.extended, where=alone[..., None])
        # Few pixels: those of the edges alone, unless the whole part is translucent.
        mixed = np.nonzero((over > 0) & ~alone)
        if mixed[0].size:
            share = over[mixed][:, None]
            behind = ((1 - share) * seen[mixed][:, None]) * normals[mixed]
            normals[mixed] = unit((share * front.extended[mixed] + behind)[None], front=True)[0]
        seen = over + (1 - over) * seen
        alpha = front.alpha + (1 - front.alpha) * alpha
        mask |= front.mask
        if confidence is None or front.confidence is None:
            confidence = None
        else:
            confidence = np.where(front.mask, front.confidence, confidence)
    off = seen <= 0
    if off.any():
        nearest = np.argmin([_distance(each) for each in maps], axis=0)
        for i, each in enumerate(maps):
            np.copyto(normals, each.extended, where=(off & (nearest == i))[..., None])
    findings = tuple(dict.fromkeys(finding for each in maps for finding in each.findings))
    return NormalMap(normals, mask, alpha, tiled([each.seen for each in maps]), confidence, findings)


def tiled(pictures: Sequence[Floats]) -> Floats:
    """Return pictures (H, W) side by side, in a square or nearly one; the rest is 0."""
    columns = math.ceil(math.sqrt(len(pictures)))
    height, width = np.max([each.shape for each in pictures], axis=0)
    every = [np.pad(each, ((0, height - each.shape[0]), (0, width - each.shape[1]))) for each in pictures]
    every += [np.zeros((height, width), np.float32)] * (-len(pictures) % columns)
    return np.vstack([np.hstack(every[i : i + columns]) for i in range(0, len(every), columns)])


def _opacity(part: NormalMap) -> Floats:
    """Return the opacity (H, W) of a part, above 0 wherever its mask is."""
    return np.where(part.mask, np.maximum(part.alpha, _THIN), part.alpha)


def _distance(part: NormalMap) -> Floats:
    """Return how far (H, W), in pixels, each pixel is from a part."""
    off = (_opacity(part) <= 0).astype(np.uint8)
    return np.asarray(cv2.distanceTransform(off, cv2.DIST_L2, 3), np.float32)
