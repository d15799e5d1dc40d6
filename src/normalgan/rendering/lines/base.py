"""LineDrawing: base class of line styles, which trace the lines of an object, and a check of their output."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from normalgan.errors import InputError
from normalgan.ranges import RangeChecked
from normalgan.registry import Registry
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View


class LineDrawing(RangeChecked, ABC):
    """Base class of line styles.

    A style is a frozen dataclass that does not use torch. Its fields are its settings. The cache key of
    rendered samples covers them and the source file of the class, but not the imports of that file. Hand
    and ink are applied afterwards.
    """

    @abstractmethod
    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the exact lines of the drawing as strokes, in pixels of a sketch with side ``view.size``.

        Args:
            view: view of the object; ``view.maps(scale)`` returns its maps.
            rng: source of randomness; the same view and generator must give the same strokes.
        """


LINE_DRAWINGS: Registry[LineDrawing] = Registry(LineDrawing, "normalgan.line_drawings")  # type: ignore[type-abstract]


def check_strokes(style: object, strokes: object, size: int) -> Sequence[Stroke]:
    """Return a line style's strokes after checking them for a picture with side ``size``.

    Raises:
        InputError: if the strokes are invalid. Strokes far outside the picture are refused instead of
            clipped, because drawing takes time and memory for each pixel along a line.
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
