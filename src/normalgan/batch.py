"""Batch: the interface between data and model."""

from typing import NotRequired, TypedDict

from torch import Tensor


class Sketches(TypedDict):
    """The generator's input: sketches, and hints if the user gave any."""

    sketch: Tensor
    """(N, 1, H, W) in [0, 1]; ink is 1, paper 0."""
    hints: NotRequired[Tensor]
    """(N, 4, H, W): unit normals at the hinted pixels, and a channel that is 1 there; zero elsewhere."""
    name: NotRequired[list[str]]
    """Names of the N samples, for error messages and file names."""


class Batch(Sketches):
    """Sketches with the true normals, for training and testing."""

    normal: Tensor
    """(N, 3, H, W) unit vectors in camera space (x right, y up, z to the viewer), 0 outside the object."""
    mask: Tensor
    """(N, 1, H, W), 1 on the object and 0 elsewhere."""
