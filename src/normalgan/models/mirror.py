"""Mirror: the mirror image of a drawing has that of its map, in which normals face the other way."""

import torch
import torch.nn.functional as F
from torch import Tensor

from normalgan.predictions import Predictions

__all__ = ["mean_of_mirrored", "mirror_condition"]


def mirror_condition(condition: Tensor) -> Tensor:
    """Return what a generator is given, (N, 4, H, W), of the mirror image of the drawing."""
    normals, where = condition[:, :3], condition[:, 3:]
    # The sketch is painted into the same channels, and has no direction.
    return torch.cat([torch.where(where > 0.5, _turned(normals), normals), where], dim=1).flip(3)


def mean_of_mirrored(preds: Predictions) -> Predictions:
    """Return the mean of what was painted for drawings and, after them, for their mirror images.

    Directions count by their confidence, where there is one.

    Args:
        preds: of 2 N drawings, unit directions (2 N, 3, H, W).

    Returns:
        Of the first N.
    """
    direction, presence, confidence = preds
    count = len(direction) // 2  # and slices: ONNX's exporter cannot take halves by chunk
    here, there = direction[:count], _turned(direction[count:].flip(3))
    if confidence is not None:
        sure, mirrored = confidence[:count], confidence[count:].flip(3)
        here, there, confidence = here * sure, there * mirrored, (sure + mirrored) / 2
    if presence is not None:
        presence = (presence[:count] + presence[count:].flip(3)) / 2
    return Predictions(F.normalize(here + there, dim=1, eps=1e-6), presence, confidence)


def _turned(normals: Tensor) -> Tensor:
    """Return normals (N, 3, H, W) whose x is negated."""
    return torch.cat([-normals[:, :1], normals[:, 1:]], dim=1)
