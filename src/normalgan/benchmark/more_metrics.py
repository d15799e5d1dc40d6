"""Metrics that a plan names beside those that are always measured."""

from collections.abc import Sequence
from typing import Any

from normalgan.metrics import METRICS, MapMetric
from normalgan.metrics.collection import check_names
from normalgan.weights.class_spec import ANY_NUMBER, ClassSpec

__all__ = ["more_metrics"]


def more_metrics(named: Sequence[str | dict[str, Any]]) -> list[MapMetric]:
    """Return the metrics that a plan names.

    Args:
        named: names of registered classes, or these as ``class_path`` with ``init_args``.

    Raises:
        InputError: if there is no such metric, it does not take its settings, or two have the same name.
    """
    given = [{"class_path": each} if isinstance(each, str) else each for each in named]
    metrics = [ClassSpec.of(each, ANY_NUMBER).build(METRICS) for each in given]
    check_names(metrics)
    return metrics
