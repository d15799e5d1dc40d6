"""Gathering: smoothing that follows surfaces and stops at barriers."""

import cv2
import numpy as np

from normalgan.normals import Floats

__all__ = ["spread"]

_FADED = 0.005
"""What has faded to less is left out."""
_COLUMNS = 128
"""So many at once stay in a processor's cache."""


def spread(planes: Floats, cost: Floats, reach: float) -> Floats:
    """Return planes (C, H, W) smoothed over about ``reach`` pixels, but hardly across what is costly.

    The domain transform of Gastal and Oliveira 2011, "Domain Transform for Edge-Aware Image and Video
    Processing", with recursive filtering, once along columns and once along rows. Their recursion,
    y[i] = (1 - a[i]) x[i] + a[i] y[i-1], is a chain of maps that are composed in pairs, then in fours, and so
    on (Hillis and Steele 1986, "Data Parallel Algorithms"), for all columns at once, as far as anything is
    left of what is carried along.

    Args:
        planes: values and their weight, each multiplied by the weight.
        cost: (H, W), how much longer than a pixel the way through each pixel is.
        reach: standard deviation in pixels.
    """
    decay = np.exp(np.float32(-np.sqrt(2) / reach) * (1 + cost))
    steps = int(np.ceil(np.log2(-np.log(_FADED) * reach / np.sqrt(2))))
    down = _along(planes, decay, steps)
    return _turned(_along(_turned(down), np.asarray(cv2.transpose(decay), np.float32), steps))


def _turned(planes: Floats) -> Floats:
    """Return planes (C, H, W) as (C, W, H)."""
    # Plane by plane: NumPy takes three times as long to turn all at once.
    return np.stack([np.asarray(cv2.transpose(plane), np.float32) for plane in planes])


def _along(planes: Floats, decay: Floats, steps: int) -> Floats:
    """Return planes (C, H, W) after a pass down the columns and one up."""
    out = np.empty_like(planes, order="C")
    # Between two rows the dearer of both decides.
    between = np.minimum(decay[1:], decay[:-1])
    for left in range(0, planes.shape[2], _COLUMNS):
        own = np.s_[left : left + _COLUMNS]
        block = np.ascontiguousarray(planes[..., own])
        _down(block, between[:, own], steps)
        block = np.ascontiguousarray(block[:, ::-1])
        _down(block, between[::-1, own], steps)
        out[..., own] = block[:, ::-1]
    return out


def _down(planes: Floats, between: Floats, steps: int) -> None:
    """Let each row of planes (C, H, W) carry over to those below, in place."""
    kept = np.zeros(planes.shape[1:], np.float32)
    kept[1:] = between
    planes *= 1 - kept
    carried = np.empty_like(planes)
    for k in (2**i for i in range(steps)):
        np.multiply(kept[k:], planes[:, :-k], out=carried[:, k:])
        planes[:, k:] += carried[:, k:]
        kept[k:] *= kept[:-k].copy()
        kept[:k] = 0
