"""The losses that compare a painted map with the true one, pixel by pixel."""

from torch import Tensor

__all__ = ["hint_loss", "l1_loss"]


def l1_loss(preds: Tensor, target: Tensor) -> Tensor:
    """Return the mean absolute difference over pixels and channels (He et al. 2021, equation 5).

    Args:
        preds: painted normals (N, 3, H, W).
        target: true normals (N, 3, H, W).
    """
    return (preds - target).abs().mean()


def hint_loss(preds: Tensor, target: Tensor, where: Tensor) -> Tensor:
    """Return the mean over hinted pixels of the channel sum of differences (He et al. 2021, equation 6).

    To be taken on what the generator painted itself: once the truth has been pasted in at the hints, it
    is zero whatever the generator does. Without any hint it is 0.

    Args:
        preds: painted normals (N, 3, H, W), before the truth is pasted in.
        target: true normals (N, 3, H, W).
        where: (N, 1, H, W), 1 at the hints.
    """
    return ((preds - target).abs() * where).sum() / where.sum().clamp(min=1)
