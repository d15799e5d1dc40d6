"""Normalisation of vectors in image tensors.

This is not part of ``normalgan.metrics`` because torchmetrics takes as long to import as torch, and the
workers that load samples do not need it.
"""

import torch
from torch import Tensor


def unit_vectors(vectors: Tensor) -> Tensor:
    """Return (N, 3, H, W) vectors scaled to length 1; the zero vector stays zero.

    Example:
        >>> unit_vectors(torch.tensor([3.0, 4.0, 0.0]).view(1, 3, 1, 1)).flatten().tolist()
        [0.6000000238418579, 0.800000011920929, 0.0]
    """
    vectors = of_unit_size(vectors.to(torch.promote_types(vectors.dtype, torch.float32)))
    return vectors / length(vectors).clamp(min=1.0)  # at least 1, unless the vector is zero


def unit_vectors_within(vectors: Tensor, mask: Tensor) -> Tensor:
    """Return (N, 3, H, W) vectors scaled to length 1 where the mask is 1, and 0 where it is 0.

    It is faster than `unit_vectors` but does not guard against overflow of squares, so use it for stored
    or interpolated normals. Vectors shorter than 1e-6 stay shorter than 1.

    Args:
        vectors: (N, 3, H, W) of float32 or float64.
        mask: (N, 1, H, W) of the same type.

    Example:
        >>> vectors = torch.tensor([[3.0, 4.0, 0.0], [0.0, 0.0, 2.0]]).view(2, 3, 1, 1)
        >>> unit_vectors_within(vectors, torch.tensor([1.0, 0.0]).view(2, 1, 1, 1)).flatten(1).tolist()
        [[0.6000000238418579, 0.800000011920929, 0.0], [0.0, 0.0, 0.0]]
    """
    x, y, z = vectors.unbind(1)
    lengths = torch.addcmul(torch.addcmul(x * x, y, y), z, z).sqrt()
    return vectors * (mask / lengths.clamp(min=1e-6)[:, None])


def of_unit_size(vectors: Tensor) -> Tensor:
    """Scale each vector to a largest coordinate of ±1, so that squares can neither under- nor overflow."""
    largest = vectors.abs().amax(1, keepdim=True)
    return vectors / torch.where(largest == 0, 1.0, largest)


def length(vectors: Tensor) -> Tensor:
    """Return lengths (N, 1, H, W), 16 times faster on a CPU than `torch.linalg.vector_norm` over dim 1."""
    return vectors.square().sum(1, keepdim=True).sqrt()
