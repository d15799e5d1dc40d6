"""Collections of all metrics of normal maps, with shared state."""

from collections.abc import Sequence
from itertools import chain

from torchmetrics import Metric, MetricCollection

from normalgan.errors import InputError
from normalgan.metrics.angular import (
    MeanAngularError,
    MeanAngularErrorPerImage,
    MedianAngularError,
    RootMeanSquareAngularError,
    ShareBelow,
)
from normalgan.metrics.base import MapMetric
from normalgan.metrics.distance import MeanL1, MeanL2
from normalgan.metrics.relief import RELIEF

_THRESHOLDS = (5.0, 7.5, 11.25, 22.5, 30.0)
"""Usual thresholds in degrees: Bae and Davison, DSINE, CVPR 2024, and earlier Fouhey et al., ICCV 2013."""
FIGURES = (
    *("angular_mean", "angular_median", "angular_rmse", "angular_mean_per_image"),
    *("below_5", "below_7_5", "below_11_25", "below_22_5", "below_30", "l1", "l2"),
)
"""Names of the metrics that are always computed."""
PRESENCE = ("mask_iou", "coverage")
"""Names of the metrics of the predicted object mask, which tests and benchmarks add."""


def check_names(more: Sequence[MapMetric]) -> None:
    """Raise `InputError` if two extra metrics, or an extra and a built-in one, have the same name."""
    seen = {*FIGURES, *PRESENCE, *RELIEF}
    for metric in more:
        if metric.figure in seen:
            raise InputError(
                f"two metrics are called {metric.figure}, one of them {type(metric).__name__}; leave one out."
            )
        seen.add(metric.figure)


def normal_map_metrics(
    prefix: str = "", more: Sequence[MapMetric] = (), own: Sequence[Sequence[MapMetric]] = ()
) -> MetricCollection:
    """Return the metrics of normal maps, with one shared state that `update` computes only once.

    Their names are ``angular_mean``, ``angular_median``, ``angular_rmse``, ``angular_mean_per_image``,
    ``below_5``, ``below_7_5``, ``below_11_25``, ``below_22_5``, ``below_30``, ``l1`` and ``l2``. Call
    ``update(preds, target, mask)``, then ``compute()``. Calling the collection itself updates each metric
    separately.

    Args:
        prefix: prefix of each name, such as ``val/``.
        more: extra metrics, which are copied and named by their `figure`.
        own: additional groups of built-in metrics; the metrics of a group share one state.

    Raises:
        InputError: if two metrics have the same name.

    Example:
        >>> import torch
        >>> metrics = normal_map_metrics("val/")
        >>> flat = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
        >>> metrics.update(flat, flat, torch.ones(1, 1, 1, 1))
        >>> metrics.compute()["val/below_11_25"]
        tensor(1.)
    """
    metrics: dict[str, Metric] = {
        "angular_mean": MeanAngularError(),
        "angular_median": MedianAngularError(),
        "angular_rmse": RootMeanSquareAngularError(),
        "angular_mean_per_image": MeanAngularErrorPerImage(),
        "l1": MeanL1(),
        "l2": MeanL2(),
    }
    metrics |= {share.figure: share for share in (ShareBelow(t) for t in _THRESHOLDS)}
    known = sorted(metrics)
    check_names(more)
    groups = [known, *([metric.figure for metric in group] for group in (*own, *([each] for each in more)))]
    metrics |= {metric.figure: metric.clone() for metric in (*chain(*own), *more)}
    # Explicit groups, because torchmetrics would otherwise update each metric once to compare states.
    return MetricCollection(metrics, prefix=prefix or None, compute_groups=groups)  # type: ignore[arg-type]
