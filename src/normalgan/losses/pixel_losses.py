"""Losses that compare a predicted map with the true one, pixel by pixel."""

from torch import Tensor

__all__ = ["hint_loss", "l1_loss"]


def l1_loss(preds: Tensor, target: Tensor) -> Tensor:
    """Return the mean absolute difference over pixels and channels (He et al. 2021, equation 5).

    Args:
        preds: predicted normals (N, 3, H, W).
        target: true normals (N, 3, H, W).
    """
    return (preds - target).abs().mean()


def hint_loss(preds: Tensor, target: Tensor, where: Tensor) -> Tensor:
    """Return the mean over hinted pixels of the channel sum of differences (He et al. 2021, equation 6).

    Apply it to the generator's own output: after the truth is pasted in at the hints it is always 0.
    Without any hint it is 0.

    Args:
        preds: predicted normals (N, 3, H, W), before the truth is pasted in.
        target: true normals (N, 3, H, W).
        where: (N, 1, H, W), 1 at the hints.
    """
    return ((preds - target).abs() * where).sum() / where.sum().clamp(min=1)
