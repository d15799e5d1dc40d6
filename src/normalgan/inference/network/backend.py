"""Backend: protocol of networks that predict the coarse map of a prepared drawing."""

from typing import Protocol

from normalgan.arrays import Floats
from normalgan.inference.network.upsampling import Upsampler
from normalgan.line_widths import LineWidths


class Backend(Protocol):
    """A network that predicts one sketch at a time; several threads may call it."""

    @property
    def size(self) -> int:
        """Side of the input and the output in pixels."""
        ...

    @property
    def line_widths(self) -> LineWidths:
        """Range of line widths, in pixels of the input, that are kept as drawn."""
        ...

    @property
    def upsample(self) -> Upsampler:
        """The upsampler from the network's size to the drawing's."""
        ...

    def predict(self, sketch: Floats, hints: Floats | None = None) -> tuple[Floats, Floats | None]:
        """Return the prediction for a sketch and its confidence.

        Args:
            sketch: (S, S), ink in [0, 1].
            hints: (4, S, S), unit normals at the hints and the mask of the hints; None for no hints.

        Returns:
            Vectors (S, S, 3) in camera space, whose length is the probability of an object, and the
            confidence κ (S, S) or None.
        """
        ...
