"""Quality of predicted normal maps: per-pixel errors, and metrics over data sets."""

from normalgan.metrics.angular import (
    MeanAngularError,
    MeanAngularErrorPerImage,
    MedianAngularError,
    RootMeanSquareAngularError,
    ShareBelow,
)
from normalgan.metrics.base import METRICS, MapMetric, NormalMapMetric
from normalgan.metrics.collection import normal_map_metrics
from normalgan.metrics.distance import MeanL1, MeanL2
from normalgan.metrics.functional import angular_error, l1_distance, l2_distance, unit_vectors, without_hints
from normalgan.metrics.stage import StageMetrics
from normalgan.registry import import_modules

import_modules(__name__)

__all__ = [
    "METRICS",
    "MapMetric",
    "MeanAngularError",
    "MeanAngularErrorPerImage",
    "MeanL1",
    "MeanL2",
    "MedianAngularError",
    "NormalMapMetric",
    "RootMeanSquareAngularError",
    "ShareBelow",
    "StageMetrics",
    "angular_error",
    "l1_distance",
    "l2_distance",
    "normal_map_metrics",
    "unit_vectors",
    "without_hints",
]
