"""Backend: a network that predicts the coarse map of a prepared drawing, by ONNX Runtime or torch."""

from typing import Protocol

from normalgan.arrays import Floats
from normalgan.inference.network.upsampling import Upsampler
from normalgan.line_widths import LineWidths

__all__ = ["Backend"]


class Backend(Protocol):
    """A network that predicts one sketch at a time; several threads may call it."""

    @property
    def size(self) -> int:
        """Side in pixels of the pictures that it takes and predicts."""
        ...

    @property
    def line_widths(self) -> LineWidths:
        """The lines that it is shown as they were drawn, in pixels of its pictures."""
        ...

    @property
    def upsample(self) -> Upsampler:
        """The step from that size to a drawing's."""
        ...

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the prediction for one sketch, and its confidence.

        Args:
            sketch: (S, S) ink in [0, 1].
            hints: (4, S, S) unit normals at the hints, and where they are; None for no hints.

        Returns:
            (S, S, 3) vectors in camera space, whose length is the probability of an object, and the
            confidence κ (S, S) or None.
        """
        ...
