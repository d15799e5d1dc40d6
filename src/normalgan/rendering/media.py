"""Medium: the effects of pen, paper and scanner on a drawing."""

from dataclasses import dataclass
from typing import Annotated

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.ranges import Range, UnitInterval, check_ranges


@dataclass(frozen=True)
class Medium:
    """Effects of pen, paper and scanner on the pixels of a drawing, after the strokes are drawn.

    Each effect has a random amount per drawing, from 0 to 1 times its setting.

    Args:
        strength: range of the common factor of a drawing's effects; 0 leaves the drawing unchanged.
        pencil: fraction of drawings in pencil; the others are in ink.
        grain: maximum fraction of a pencil line that the texture of the paper leaves white.
        lightness: maximum difference in lightness between pencil and ink.
        bleed: maximum spread of ink, as a fraction of the frame's side.
        tint: maximum darkness of the paper, where 1 is black.
        shadow: maximum difference in lightness between two sides of the paper.
        noise: maximum standard deviation of the scanner's noise.
    """

    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    pencil: UnitInterval = 0.4
    grain: UnitInterval = 0.8
    lightness: UnitInterval = 0.5
    bleed: UnitInterval = 0.002
    tint: UnitInterval = 0.12
    shadow: UnitInterval = 0.15
    noise: UnitInterval = 0.03

    def __post_init__(self) -> None:
        check_ranges(self)

    def apply(self, ink: Floats, rng: np.random.Generator) -> Floats:
        """Return the darkness of the finished picture, (H, W) in [0, 1], for its ink.

        Args:
            ink: (H, W) in [0, 1], square.
            rng: source of randomness for tool, paper and grain.
        """
        strength = rng.uniform(*self.strength)
        if strength == 0:
            return ink
        in_pencil = rng.random() < self.pencil
        grain, lightness, run, tint, shadow, noise = strength * rng.random(6)
        if in_pencil:
            ink = pencil(ink, grain * self.grain, rng) * np.float32(1 - lightness * self.lightness)
        else:
            ink = bleed(ink, run * self.bleed * len(ink))
        return scanned(on_paper(ink, tint * self.tint, shadow * self.shadow, rng), noise * self.noise, rng)


_TOOTH = 0.7  # in pixels; finer than a line, like the grain in a scan of a whole drawing


def bleed(ink: Floats, sigma: float) -> Floats:
    """Return the ink after it has bled ``sigma`` pixels into the paper; the total amount is preserved.

    Args:
        ink: (H, W) in [0, 1].
        sigma: standard deviation in pixels; 0 leaves the ink unchanged.
    """
    if sigma <= 0:
        return ink
    return np.asarray(cv2.GaussianBlur(ink, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE), np.float32)


def pencil(ink: Floats, grain: float, rng: np.random.Generator) -> Floats:
    """Return the ink as graphite, which leaves low points of the paper white, especially in light strokes.

    Args:
        ink: (H, W) in [0, 1].
        grain: from 0 for smooth paper to 1, where the lightest stroke marks only the highest points.
        rng: source of randomness for the paper.
    """
    depth = _smooth_noise(ink.shape, _TOOTH, rng)  # depth of the paper, standard normal
    reach = 0.5 + 0.25 * depth
    graphite: Floats = ink * np.clip(1 - grain * np.clip(reach, 0, 1) * (1.5 - ink), 0, 1)
    return graphite.astype(np.float32)


def _smooth_noise(shape: tuple[int, ...], sigma: float, rng: np.random.Generator) -> Floats:
    """Return noise of standard deviation 1 that is correlated over ``sigma`` pixels."""
    noise = rng.standard_normal(shape, dtype=np.float32)
    noise = np.asarray(cv2.GaussianBlur(noise, (0, 0), sigma, borderType=cv2.BORDER_REFLECT), np.float32)
    # Blurred white noise has a variance of 1 / (4 π σ²), but less for a small kernel, so it is measured.
    return noise / max(float(noise.std()), 1e-6)


def on_paper(ink: Floats, tint: float, shadow: float, rng: np.random.Generator) -> Floats:
    """Return the darkness of a drawing on tinted, unevenly lit paper.

    Paper and ink filter light, so their lightnesses are multiplied.

    Args:
        ink: (H, W) in [0, 1].
        tint: darkness of the paper, where 0 is white.
        shadow: difference in darkness between the darkest and the brightest corner.
        rng: source of randomness for the direction and falloff of the light.
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
    """Return the drawing with sensor noise.

    Args:
        darkness: (H, W) in [0, 1].
        noise: standard deviation of the noise.
        rng: source of randomness.
    """
    noisy: Floats = darkness + np.float32(noise) * rng.standard_normal(darkness.shape, dtype=np.float32)
    return np.clip(noisy, 0, 1)
