"""LineDrawing: the base of the line styles, which trace the lines of an object, and the check of these."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from normalgan.errors import InputError
from normalgan.registry import Registry
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["LINE_DRAWINGS", "LineDrawing", "check_strokes"]


class LineDrawing(ABC):
    """Base of the line styles.

    A style is a frozen dataclass that uses NumPy only. Its fields are its settings. The cache key of rendered
    samples covers them and the source file of the class, but not what that file imports. The hand and the ink
    come after it.
    """

    @abstractmethod
    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the exact lines of the drawing, each a `Stroke` in pixels, ``view.size`` a side.

        Args:
            view: the object and where it is seen from; ``view.maps(scale)`` are its maps.
            rng: for random choices; the same view and generator give the same strokes.
        """


LINE_DRAWINGS: Registry[LineDrawing] = Registry(LineDrawing, "normalgan.line_drawings")  # type: ignore[type-abstract]


def check_strokes(style: object, strokes: object, size: int) -> Sequence[Stroke]:
    """Return a line style's strokes after checking them for a picture of ``size`` pixels a side.

    Raises:
        InputError: otherwise. Strokes far outside are refused, not clipped, because drawing
            costs time and memory for every pixel along a line.
    """
    name = type(style).__name__
    asked, given = "a line style gives a list of Stroke", type(strokes).__name__
    if not isinstance(strokes, list | tuple):
        raise InputError(f"{name} gave {given}; {asked}.")
    if others := [type(each).__name__ for each in strokes if not isinstance(each, Stroke)]:
        raise InputError(f"{name} gave {given} of {others[0]}; {asked}.")
    for stroke in strokes:
        for part in ("points", "width", "darkness"):
            if not np.isfinite(getattr(stroke, part)).all():
                raise InputError(f"{name} gave a stroke whose {part} are not numbers; they must be finite.")
        low, high = float(stroke.points.min()), float(stroke.points.max())
        if low < -size or high > 2 * size or not 0 <= stroke.width.min() <= stroke.width.max() <= 4 * size:
            raise InputError(
                f"{name} gave a stroke from {low:.6g} to {high:.6g} pixels, up to "
                f"{stroke.width.max():.6g} wide, for a sketch of {size}; points and widths are in its pixels."
            )
    return strokes
