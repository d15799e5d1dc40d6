"""Items: single samples as tensors, which torch's `default_collate` combines to batches."""

from collections.abc import Mapping
from typing import NotRequired, TypedDict, cast

import torch
from torch import Tensor
from torch.utils.data import default_collate

from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.vectors import unit_vectors_within


class SampleError(InputError):
    """Error for a sample that cannot be read or created, in one sentence even if raised in a worker process.

    torch rebuilds a worker's error in the training process from a text that starts with the origin and
    ends with the error.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text.rpartition(f"{type(self).__name__}: ")[2].strip())


class Item(TypedDict):
    """A sample in the stored types; see `Batch` for the axes and `decode` for the ranges."""

    sketch: Tensor
    """(1, H, W), uint8, ink 255"""
    normal: Tensor
    """(3, H, W), half precision, approximately unit length"""
    mask: Tensor
    """(1, H, W), bool"""
    hints: NotRequired[Tensor]
    """(4, H, W), half precision; only if the samples have hints"""
    name: str
    """Mesh and view index, such as ``horse-0001/17``."""


def to_item(arrays: Mapping[str, Tensor], name: str) -> Item:
    """Return the arrays of a `Sample`, given by name, as an item with channels first and the stored types.

    An item takes a quarter of the memory of the network's input; see `decode`.
    """
    turned = {
        key: array[None] if array.ndim == 2 else array.permute(2, 0, 1) for key, array in arrays.items()
    }
    return cast(Item, {**turned, "name": name})


def decode(batch: Batch) -> Batch:
    """Decode a batch for the network, on its device; a batch that is already decoded is returned unchanged.

    Ink is in [0, 1], masks are 0 or 1, and normals are rescaled to unit length on the object and set to 0
    elsewhere.
    """
    sketch, normal, mask = batch["sketch"], batch["normal"], batch["mask"]
    if not sketch.is_floating_point():
        sketch = sketch.float() / 255
    on = mask.float()
    if normal.dtype == torch.float16 or not mask.is_floating_point():
        normal = unit_vectors_within(normal.float(), on)
    decoded: Batch = {**batch, "sketch": sketch, "normal": normal, "mask": on}
    if "hints" in batch and batch["hints"].dtype == torch.float16:
        hints = batch["hints"].float()
        where = hints[:, 3:]
        decoded["hints"] = torch.cat([unit_vectors_within(hints[:, :3], where), where], dim=1)
    return decoded


def collate_decoded(items: list[Item]) -> Batch:
    """Collate samples to a decoded batch for the network."""
    return decode(default_collate(items))
