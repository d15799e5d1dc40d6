"""Pen and pencil: ink that bleeds, graphite that skips the low parts of the paper."""

import cv2
import numpy as np

from normalgan.arrays import Floats

__all__ = ["bleed", "pencil"]

_TOOTH = 0.7  # pixels; finer than the line, like the grain in a scan of a whole drawing


def bleed(ink: Floats, sigma: float) -> Floats:
    """Return ink that has bled ``sigma`` pixels into the paper; its total is kept.

    Args:
        ink: (H, W) in [0, 1].
        sigma: standard deviation in pixels; 0 leaves the ink as it is.
    """
    if sigma <= 0:
        return ink
    return np.asarray(cv2.GaussianBlur(ink, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE), np.float32)


def pencil(ink: Floats, grain: float, rng: np.random.Generator) -> Floats:
    """Return the ink as graphite: where the paper is low it stays white, the more the lighter the touch.

    Args:
        ink: (H, W) in [0, 1].
        grain: from 0 for smooth paper to 1, where the lightest touch marks only the highest points.
        rng: the paper.
    """
    depth = _smooth_noise(ink.shape, _TOOTH, rng)  # standard normal: the depth of the paper
    reach = 0.5 + 0.25 * depth
    graphite: Floats = ink * np.clip(1 - grain * np.clip(reach, 0, 1) * (1.5 - ink), 0, 1)
    return graphite.astype(np.float32)


def _smooth_noise(shape: tuple[int, ...], sigma: float, rng: np.random.Generator) -> Floats:
    """Return noise of standard deviation 1 that is correlated over ``sigma`` pixels."""
    noise = rng.standard_normal(shape, dtype=np.float32)
    noise = np.asarray(cv2.GaussianBlur(noise, (0, 0), sigma, borderType=cv2.BORDER_REFLECT), np.float32)
    # Blurred white noise keeps 1 / (4 π σ²) of its variance, but less with a small kernel, so it is measured.
    result: Floats = noise / max(float(noise.std()), 1e-6)
    return result
