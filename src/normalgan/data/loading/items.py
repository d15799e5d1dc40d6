"""Items: one sample as tensors; torch's `default_collate` makes a batch of several."""

from collections.abc import Mapping
from typing import NotRequired, TypedDict, cast

import torch
from torch import Tensor
from torch.utils.data import default_collate

from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.vectors import unit_vectors_within

__all__ = ["Item", "SampleError", "collate_decoded", "decode", "to_item"]


class SampleError(InputError):
    """A sample that cannot be read or made; one sentence, from a worker process too.

    torch rebuilds a worker's error in the training process, from a text that starts with its origin and ends
    with the error.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text.rpartition(f"{type(self).__name__}: ")[2].strip())


class Item(TypedDict):
    """One sample as it is stored; see `Batch` for the axes, and `decode` for the ranges."""

    sketch: Tensor
    """(1, H, W); stored as uint8, ink 255"""
    normal: Tensor
    """(3, H, W); stored in half precision, of about unit length"""
    mask: Tensor
    """(1, H, W); stored as bool"""
    hints: NotRequired[Tensor]
    """(4, H, W), if samples bring hints; stored in half precision"""
    name: str
    """Mesh and number of the view, such as ``horse-0001/17``."""


def to_item(arrays: Mapping[str, Tensor], name: str) -> Item:
    """Return the arrays of a `Sample`, by name, as an item: channels first, of the types that are stored.

    That is a quarter of the bytes of the network's input; see `decode`.
    """
    turned = {
        key: array[None] if array.ndim == 2 else array.permute(2, 0, 1) for key, array in arrays.items()
    }
    return cast(Item, {**turned, "name": name})


def decode(batch: Batch) -> Batch:
    """Decode a batch for the network, on its device; a decoded batch is returned unchanged.

    Ink is in [0, 1], masks are 0 or 1, and normals are rescaled to unit length on the object and are 0 off
    it.
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
    """Return samples as a batch for the network."""
    return decode(default_collate(items))
