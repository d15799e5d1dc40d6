"""Composition: composite the maps of parts that were predicted separately."""

import math
from collections.abc import Sequence

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.vectors import unit

_THIN = np.float32(1 / 255)
"""Opacity given to mask pixels whose soft edge has no opacity, such as very thin parts."""


def compose(maps: Sequence[NormalMap]) -> NormalMap:
    """Return the composite of the maps of a drawing's parts.

    A part hides the parts behind it. Along soft edges and where a part is translucent, its normals are
    averaged with the normals behind it, weighted by visibility (Porter and Duff's "over", 1984). Outside all
    parts, the normals come from the nearest part, so that edges keep their normals.

    Args:
        maps: maps of the same size (H, W), back to front; a single map is returned unchanged.

    Raises:
        ValueError: if there are no maps or their sizes differ.
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
        # Only edge pixels, unless the whole part is translucent.
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
    """Return pictures (H, W) in a roughly square grid, padded with zeros."""
    columns = math.ceil(math.sqrt(len(pictures)))
    height, width = np.max([each.shape for each in pictures], axis=0)
    every = [np.pad(each, ((0, height - each.shape[0]), (0, width - each.shape[1]))) for each in pictures]
    every += [np.zeros((height, width), np.float32)] * (-len(pictures) % columns)
    return np.vstack([np.hstack(every[i : i + columns]) for i in range(0, len(every), columns)])


def _opacity(part: NormalMap) -> Floats:
    """Return the opacity (H, W) of a part, above 0 wherever its mask is."""
    return np.where(part.mask, np.maximum(part.alpha, _THIN), part.alpha)


def _distance(part: NormalMap) -> Floats:
    """Return the distance (H, W) of each pixel from a part, in pixels."""
    off = (_opacity(part) <= 0).astype(np.uint8)
    return np.asarray(cv2.distanceTransform(off, cv2.DIST_L2, 3), np.float32)
