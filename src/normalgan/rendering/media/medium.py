"""Medium: effects of pen, paper and scanner."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.arrays import Floats
from normalgan.ranges import Range, Share, check_ranges
from normalgan.rendering.media.paper import on_paper, scanned
from normalgan.rendering.media.tools import bleed, pencil

__all__ = ["Medium"]


@dataclass(frozen=True)
class Medium:
    """Pen, paper and scanner: effects on the pixels of a drawing, after its strokes are drawn.

    Every drawing gets a random share, from 0 to 1, of each effect.

    Args:
        strength: range of the factor that a drawing's effects share; at 0 the drawing stays as it is.
        pencil: share of drawings in pencil; the others are in ink.
        grain: how much of a pencil line the tooth of the paper leaves white, at most.
        lightness: how much lighter than ink a pencil line is, at most.
        bleed: how far ink runs at most, as a fraction of the frame's side.
        tint: how dark the paper is at most, 1 being black.
        shadow: largest difference in lightness between two sides of the paper.
        noise: standard deviation of the scanner's noise, at most.

    Raises:
        InputError: if a setting is not from 0 to 1, or the range of strengths is upside down.
    """

    strength: Annotated[tuple[float, float], Range(0, 1)] = (0.0, 1.0)
    pencil: Share = 0.4
    grain: Share = 0.8
    lightness: Share = 0.5
    bleed: Share = 0.002
    tint: Share = 0.12
    shadow: Share = 0.15
    noise: Share = 0.03

    def __post_init__(self) -> None:
        check_ranges(self)

    def apply(self, ink: Floats, rng: np.random.Generator) -> Floats:
        """Return the darkness of the finished picture, (H, W) in [0, 1], from its ink.

        Args:
            ink: (H, W) in [0, 1], square.
            rng: which tool and paper, and their grain.
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
