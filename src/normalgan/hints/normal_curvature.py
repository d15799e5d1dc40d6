"""The curvature of a surface, computed from its normal map."""

from typing import Literal

import torch
import torch.nn.functional as F
from torch import Tensor

Estimator = Literal["central", "sobel"]


def curvature_map(
    normal: Tensor, estimator: Estimator = "central", signed: bool = True, blur: float = 0.0
) -> Tensor:
    """Return the curvature of the surface at every pixel, in 1/pixel, in float32 or higher precision.

    The signed curvature is the divergence of the normal in the picture, ∂nx/∂x + ∂ny/∂y with x to the
    right and y up: ridges are positive, valleys negative, flat is 0. An orthographic sphere of radius r
    pixels has 2/r everywhere. The unsigned curvature is the Frobenius norm of the normal's gradient. In a
    colour normal map, (n + 1) / 2, the difference between the two neighbours of a pixel has the same
    value. Tools that make a "curvature map" from a normal map compute this sum: red across columns plus
    green across rows.

    Border pixels are repeated outside the picture. The zero normal outside the object counts as facing the
    viewer in the signed form, so a convex object has a strong negative outline.

    Args:
        normal: (N, 3, H, W) unit normals, row 0 at the top.
        estimator: ``central`` differences, or ``sobel``, which also averages across them by (1, 2, 1) / 4.
        signed: divergence (True) or norm of the gradient (False).
        blur: standard deviation of the Gaussian blur applied to the curvature, in pixels; 0 for no blur.

    Returns:
        (N, 1, H, W) curvature.

    Example:
        >>> valley = torch.tensor([0.6, 0.0, -0.6]).expand(3, 3)  # nx falls to the right: walls lean inward
        >>> normal = torch.stack([valley, 0 * valley, (1 - valley**2).sqrt()])[None]
        >>> curvature_map(normal)[0, 0, 1, 1]
        tensor(-0.6000)
    """
    normal = normal.to(torch.promote_types(normal.dtype, torch.float32))
    along_x, along_y = _derivatives(normal, smooth=estimator == "sobel")
    if signed:
        curvature = along_x[:, 0:1] + along_y[:, 1:2]
    else:
        curvature = (along_x.square() + along_y.square()).sum(1, keepdim=True).sqrt()
    return _gaussian(curvature, blur) if blur > 0 else curvature


def _derivatives(image: Tensor, smooth: bool) -> tuple[Tensor, Tensor]:
    """Return the derivatives to the right and upwards, per pixel."""
    # Slices instead of conv2d, which would run in half precision under autocast.
    padded = F.pad(image, (1, 1, 1, 1), mode="replicate")
    rows, columns = padded[:, :, 1:-1, :], padded[:, :, :, 1:-1]
    if smooth:
        rows = (padded[:, :, :-2] + 2 * rows + padded[:, :, 2:]) / 4
        columns = (padded[..., :-2] + 2 * columns + padded[..., 2:]) / 4
    along_x = (rows[..., 2:] - rows[..., :-2]) / 2
    along_y = (columns[:, :, :-2] - columns[:, :, 2:]) / 2  # y points up, row indices grow downwards
    return along_x, along_y


def _gaussian(image: Tensor, sigma: float) -> Tensor:
    """Blur each channel with a kernel of three standard deviations, repeating the border pixels."""
    radius = max(1, round(3 * sigma))
    taps = torch.arange(-radius, radius + 1, dtype=torch.float64)
    weights = torch.exp(-0.5 * (taps / sigma) ** 2)
    kernel = (weights / weights.sum()).tolist()
    height, width = image.shape[-2:]
    padded = F.pad(image, (radius,) * 4, mode="replicate")
    across = sum((w * padded[..., i : i + width] for i, w in enumerate(kernel)), start=image.new_zeros(()))
    return sum((w * across[..., i : i + height, :] for i, w in enumerate(kernel)), start=image.new_zeros(()))
