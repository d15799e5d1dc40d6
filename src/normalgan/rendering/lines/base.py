"""LineDrawing: turns maps into the sketch a person might draw of them."""

from abc import ABC, abstractmethod

from normalgan.registry import Registry
from normalgan.rendering.maps import Floats, Maps


class LineDrawing(ABC):
    """Base of the line styles.

    A style is a frozen dataclass: its fields are its settings, and they enter the key under which
    rendered samples are stored.
    """

    supersampling: int
    """The style draws from maps rendered this many times larger than the sketch."""

    @abstractmethod
    def draw(self, maps: Maps, size: int) -> Floats:
        """Return the sketch, (``size``, ``size``) in [0, 1] with ink 1, antialiased.

        Args:
            maps: the object, rendered at ``supersampling * size`` pixels.
            size: side of the sketch in pixels.
        """


LINE_DRAWINGS: Registry[LineDrawing] = Registry(LineDrawing, "normalgan.line_drawings")  # type: ignore[type-abstract]
