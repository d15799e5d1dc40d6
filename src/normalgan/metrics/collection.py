"""All metrics of normal maps at once, counted once."""

from torchmetrics import Metric, MetricCollection

from normalgan.metrics.angular import (
    MeanAngularError,
    MeanAngularErrorPerImage,
    MedianAngularError,
    RootMeanSquareAngularError,
    ShareBelow,
)
from normalgan.metrics.distance import MeanL1, MeanL2

__all__ = ["THRESHOLDS", "normal_map_metrics"]

THRESHOLDS = (5.0, 7.5, 11.25, 22.5, 30.0)
"""Degrees of the usual shares: Bae and Davison, DSINE, CVPR 2024, and before it Fouhey et al., ICCV 2013."""


def normal_map_metrics(prefix: str = "", normalize: bool = True) -> MetricCollection:
    """Return the metrics of normal maps, sharing one state: `update` works once for all of them.

    Their names are ``angular_mean``, ``angular_median``, ``angular_rmse``, ``angular_mean_per_image``,
    ``below_5``, ``below_7_5``, ``below_11_25``, ``below_22_5``, ``below_30``, ``l1`` and ``l2``. Call
    ``update(preds, target, mask)``, then ``compute()``; calling the collection itself counts once for each.

    Args:
        prefix: put before each name, such as ``val/``.
        normalize: take L1 and L2 of predictions scaled to unit length; see `NormalMapMetric`.

    Example:
        >>> import torch
        >>> metrics = normal_map_metrics("val/")
        >>> flat = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
        >>> metrics.update(flat, flat, torch.ones(1, 1, 1, 1))
        >>> metrics.compute()["val/below_11_25"]
        tensor(1.)
    """
    metrics: dict[str, Metric] = {
        "angular_mean": MeanAngularError(normalize),
        "angular_median": MedianAngularError(normalize),
        "angular_rmse": RootMeanSquareAngularError(normalize),
        "angular_mean_per_image": MeanAngularErrorPerImage(normalize),
        "l1": MeanL1(normalize),
        "l2": MeanL2(normalize),
    }
    # No dots: torch modules cannot be named with them.
    metrics |= {f"below_{t:g}".replace(".", "_"): ShareBelow(t, normalize) for t in THRESHOLDS}
    # Groups given, not found out: torchmetrics would update each metric once to compare their states.
    return MetricCollection(metrics, prefix=prefix or None, compute_groups=[sorted(metrics)])  # type: ignore[arg-type]
