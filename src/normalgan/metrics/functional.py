"""Per-pixel distances between predicted and true normals."""

import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.vectors import length, of_unit_size, unit_vectors

__all__ = ["angular_error", "l1_distance", "l2_distance", "unit_vectors", "without_hints"]


def angular_error(preds: Tensor, target: Tensor) -> Tensor:
    """Return the angle between two maps of vectors in degrees, 0…180.

    It is computed as atan2(|p × t|, p · t), because acos of the dot product is up to 0.028° off near 0° in
    float32. The vectors may have any length. A zero vector has an angle of 90° to any other, as with
    cosine similarity (Bae and Davison, DSINE, CVPR 2024).

    Args:
        preds: (N, 3, H, W) predicted normals.
        target: (N, 3, H, W) true normals.

    Returns:
        (N, 1, H, W) degrees, in float64 if an input is float64, otherwise in float32.

    Raises:
        InputError: if the shapes differ from these.

    Example:
        >>> up, right = torch.eye(3)[1].view(1, 3, 1, 1), torch.eye(3)[0].view(1, 3, 1, 1)
        >>> round(angular_error(up + right, right).item(), 3)
        45.0
    """
    preds, target = (of_unit_size(vectors) for vectors in _checked(preds, target))
    across = length(torch.linalg.cross(preds, target, dim=1))
    along = (preds * target).sum(1, keepdim=True)
    degrees = torch.rad2deg(torch.atan2(across, along))
    undefined = (preds == 0).all(1, keepdim=True) | (target == 0).all(1, keepdim=True)
    return degrees.masked_fill(undefined, 90.0)


def l1_distance(preds: Tensor, target: Tensor) -> Tensor:
    """Return the sum over the three coordinates of the absolute differences.

    This is ‖preds - target‖₁ in equation 5 of He et al. (arXiv 2104.11554) at a pixel, with coordinates in
    [-1, 1]. Their published values are too large for a mean over coordinates or for colours in [0, 1].

    Args:
        preds: (N, 3, H, W) predicted normals.
        target: (N, 3, H, W) true normals.

    Returns:
        (N, 1, H, W), 0…2√3 for unit vectors.

    Raises:
        InputError: if the shapes differ from these.

    Example:
        >>> l1_distance(torch.ones(1, 3, 1, 1), torch.zeros(1, 3, 1, 1)).item()
        3.0
    """
    preds, target = _checked(preds, target)
    return (preds - target).abs().sum(1, keepdim=True)


def l2_distance(preds: Tensor, target: Tensor) -> Tensor:
    """Return the Euclidean distance ‖preds - target‖₂.

    Args:
        preds: (N, 3, H, W) predicted normals.
        target: (N, 3, H, W) true normals.

    Returns:
        (N, 1, H, W), 0…2 for unit vectors: twice the sine of half the angle.

    Raises:
        InputError: if the shapes differ from these.

    Example:
        >>> l2_distance(torch.tensor([3.0, 4.0, 0.0]).view(1, 3, 1, 1), torch.zeros(1, 3, 1, 1)).item()
        5.0
    """
    preds, target = _checked(preds, target)
    return length(preds - target)


def without_hints(mask: Tensor, where: Tensor) -> Tensor:
    """Return the mask without the hinted pixels, where the normals were given.

    Args:
        mask: (N, 1, H, W), 1 on the object.
        where: (N, 1, H, W), 1 at a hinted pixel.

    Returns:
        (N, 1, H, W) of the mask's type.

    Example:
        >>> without_hints(torch.tensor([1, 1, 0]), torch.tensor([0, 1, 0]))
        tensor([1, 0, 0])
    """
    return mask.masked_fill(where > 0.5, 0)


def _checked(preds: Tensor, target: Tensor) -> tuple[Tensor, Tensor]:
    """Return both maps in a common floating-point type, at least float32."""
    if preds.ndim != 4 or preds.shape[1] != 3 or preds.shape != target.shape:
        raise InputError(
            f"preds has the shape {tuple(preds.shape)} and target {tuple(target.shape)}; "
            "both must be the same (N, 3, H, W)."
        )
    dtype = torch.promote_types(torch.promote_types(preds.dtype, target.dtype), torch.float32)
    return preds.to(dtype), target.to(dtype)
