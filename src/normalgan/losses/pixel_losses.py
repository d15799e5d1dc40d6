"""Pixel-wise losses between a predicted and a true map."""

from torch import Tensor


def l1_loss(preds: Tensor, target: Tensor) -> Tensor:
    """Return the mean absolute difference over pixels and channels (He et al. 2021, equation 5).

    Args:
        preds: predicted normals (N, 3, H, W).
        target: true normals (N, 3, H, W).
    """
    return (preds - target).abs().mean()


def hint_loss(preds: Tensor, target: Tensor, where: Tensor) -> Tensor:
    """Return the L1 difference at hints, summed over channels, averaged over hints (He et al. 2021, eq. 6).

    Apply it to the raw output of the generator; after the true normals are pasted in at the hints, it is
    always 0. It is also 0 if there are no hints.

    Args:
        preds: predicted normals (N, 3, H, W), before the true normals are pasted in.
        target: true normals (N, 3, H, W).
        where: (N, 1, H, W), 1 at the hints.
    """
    return ((preds - target).abs() * where).sum() / where.sum().clamp(min=1)
