"""LineDrawing: the base of the line styles, which trace the lines of an object."""

from abc import ABC, abstractmethod

import numpy as np

from normalgan.registry import Registry
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["LINE_DRAWINGS", "LineDrawing"]


class LineDrawing(ABC):
    """Base of the line styles.

    A style is a frozen dataclass that uses NumPy only. Its fields are its settings; they and the file that
    defines the class, but not what that file imports, enter the key under which rendered samples are
    stored. The hand and the ink come after it.
    """

    @abstractmethod
    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the exact lines of the drawing, each a `Stroke` in pixels, ``view.size`` a side.

        Args:
            view: the object and where it is seen from; ``view.maps(scale)`` are its maps.
            rng: for random choices; the same view and generator give the same strokes.
        """


LINE_DRAWINGS: Registry[LineDrawing] = Registry(LineDrawing, "normalgan.line_drawings")  # type: ignore[type-abstract]
