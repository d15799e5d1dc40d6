"""The weights in an ONNX file written by `normalgan export`."""

import onnx
import torch
from onnx import numpy_helper
from onnx.external_data_helper import uses_external_data
from torch import Tensor

_NETWORK, _HALF = "generator.", ".half"
_MEAN, _COUNT = "running_mean", "num_batches_tracked"


def parse_onnx(content: bytes) -> tuple[dict[str, str], dict[str, Tensor]]:
    """Return the metadata of a file and the generator's tensors by their torch names.

    The batch counters of batch norm are not in the graph and are set to 0.

    Raises:
        ValueError: if tensors are in other files. For damaged files, the package onnx raises its own errors.
    """
    model = onnx.load_from_string(content)
    tensors: dict[str, Tensor] = {}
    for stored in model.graph.initializer:
        if uses_external_data(stored):
            raise ValueError("tensors in other files")
        if not stored.name.startswith(_NETWORK):
            continue  # constants of the graph
        name = stored.name.removeprefix(_NETWORK).removesuffix(_HALF)
        tensors[name] = torch.from_numpy(numpy_helper.to_array(stored).copy())
        if name.endswith(_MEAN):
            tensors[name.removesuffix(_MEAN) + _COUNT] = torch.zeros((), dtype=torch.int64)
    return {each.key: each.value for each in model.metadata_props}, tensors
