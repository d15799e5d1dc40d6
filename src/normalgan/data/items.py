"""Items: one sample as tensors, and how several make a batch."""

from collections.abc import Sequence
from typing import TypedDict

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.metrics import unit_vectors


class SampleError(InputError):
    """A sample that cannot be read or made; tells it in one sentence from a worker process too.

    torch makes the error of a worker anew in the process that trains, from a text that ends in the error and
    opens with where it arose.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text.rpartition(f"{type(self).__name__}: ")[2].strip())


class Item(TypedDict):
    """One sample; see `Batch` for the axes and ranges."""

    sketch: Tensor
    """(1, H, W)"""
    normal: Tensor
    """(3, H, W)"""
    mask: Tensor
    """(1, H, W)"""
    name: str
    """Mesh and number of the view, such as ``horse-0001/17``."""


def to_item(sketch: Tensor, normal: Tensor, mask: Tensor, name: str) -> Item:
    """Return a sample as the network takes it, its normals of unit length again on the object.

    Args:
        sketch: (H, W) uint8, ink 255.
        normal: (H, W, 3) of any float type.
        mask: (H, W) bool.
        name: what the sample is called.
    """
    on = mask[None].float()
    unit = unit_vectors(normal.permute(2, 0, 1)[None])[0]
    return {"sketch": sketch[None].float() / 255, "normal": unit * on, "mask": on, "name": name}


def collate(items: Sequence[Item]) -> Batch:
    """Return the samples stacked to a batch."""
    return {
        "sketch": torch.stack([item["sketch"] for item in items]),
        "normal": torch.stack([item["normal"] for item in items]),
        "mask": torch.stack([item["mask"] for item in items]),
        "name": [item["name"] for item in items],
    }
