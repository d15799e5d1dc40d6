"""Mixture: draws each picture in a randomly chosen style."""

from dataclasses import dataclass

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing, check_strokes
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View


@LINE_DRAWINGS.register
@dataclass(frozen=True)
class Mixture(LineDrawing):
    """Draws each picture in one of several styles, chosen at random.

    Args:
        styles: styles with their settings; a style may occur several times with different settings.
        weights: relative frequencies of the styles; none for equal frequencies.

    Raises:
        InputError: if there is no style, or the weights are invalid.
    """

    styles: list[LineDrawing]
    weights: list[float] | None = None

    def __post_init__(self) -> None:
        if not self.styles:
            raise InputError("the styles of Mixture are an empty list; name at least one line style.")
        if self.weights is None:
            return
        if len(self.weights) != len(self.styles):
            raise InputError(
                f"Mixture has {len(self.weights)} weights for {len(self.styles)} styles; "
                "give one weight per style."
            )
        if not (np.isfinite(self.weights).all() and min(self.weights) >= 0 and sum(self.weights) > 0):
            raise InputError(
                f"the weights of Mixture are {self.weights}; they must be numbers of 0 or "
                "more, at least one above 0."
            )

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes of one of the styles; see `LineDrawing.trace`."""
        style = self.choose(rng)
        return list(check_strokes(style, style.trace(view, rng), view.size))  # errors name the style

    def choose(self, rng: np.random.Generator) -> LineDrawing:
        """Return a random style according to the weights."""
        weights = np.ones(len(self.styles)) if self.weights is None else np.array(self.weights, np.float64)
        return self.styles[int(rng.choice(len(self.styles), p=weights / weights.sum()))]
