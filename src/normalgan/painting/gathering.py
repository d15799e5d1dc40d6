"""Gathering: smoothing that follows surfaces and stops at barriers."""

import numpy as np

from normalgan.normals import Floats

_FADED = 0.005
"""What has faded to less is left out."""


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
    return _along(down.swapaxes(1, 2), decay.T, steps).swapaxes(1, 2)


def _along(planes: Floats, decay: Floats, steps: int) -> Floats:
    """Return planes (C, H, W) after a pass down the columns and one up."""
    out = np.array(planes, order="C")
    # Between two rows the dearer of both decides.
    between = np.ascontiguousarray(np.minimum(decay[1:], decay[:-1]))
    _down(out, between, steps)
    _down(out[:, ::-1], between[::-1], steps)
    return out


def _down(planes: Floats, between: Floats, steps: int) -> None:
    """Let each row of planes (C, H, W) carry over to those below, in place."""
    kept = np.zeros(planes.shape[1:], np.float32)
    kept[1:] = between
    planes *= 1 - kept
    for k in (2**i for i in range(steps)):
        planes[:, k:] += kept[k:] * planes[:, :-k]
        kept[k:] *= kept[:-k].copy()
        kept[:k] = 0
