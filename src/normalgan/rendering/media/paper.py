"""Paper and scanner: tint, shadow, noise."""

import numpy as np

from normalgan.arrays import Floats

__all__ = ["on_paper", "scanned"]


def on_paper(ink: Floats, tint: float, shadow: float, rng: np.random.Generator) -> Floats:
    """Return the darkness of a drawing on paper that is not white and not evenly lit.

    Paper and ink act as filters of light, so their lightnesses multiply.

    Args:
        ink: (H, W) in [0, 1].
        tint: darkness of the paper, 0 white.
        shadow: how much darker than its brightest corner the paper is in the darkest.
        rng: where the light comes from, and how sharply it falls off.
    """
    height, width = ink.shape
    angle, steepness = rng.uniform(0, 2 * np.pi), rng.uniform(1, 8)
    y = np.linspace(-1, 1, height, dtype=np.float32)[:, None]
    x = np.linspace(-1, 1, width, dtype=np.float32)[None, :]
    along = (x * np.cos(angle) + y * np.sin(angle)) / (abs(np.cos(angle)) + abs(np.sin(angle)))  # -1 to 1
    shade = 1 / (1 + np.exp(-steepness * (along - rng.uniform(-0.5, 0.5))))
    low, high = float(shade.min()), float(shade.max())
    light = 1 - shadow * (shade - low) / (high - low)
    darkness: Floats = (1 - (1 - ink) * (1 - tint) * light).astype(np.float32)
    return darkness


def scanned(darkness: Floats, noise: float, rng: np.random.Generator) -> Floats:
    """Return the drawing with the noise of a sensor.

    Args:
        darkness: (H, W) in [0, 1].
        noise: standard deviation.
        rng: the noise.
    """
    noisy: Floats = darkness + np.float32(noise) * rng.standard_normal(darkness.shape, dtype=np.float32)
    return np.clip(noisy, 0, 1)
