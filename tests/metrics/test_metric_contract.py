"""Compares every metric with its definition in numpy; `normalgan.testing` checks what all metrics must do."""

from collections.abc import Callable
from functools import partial

import pytest
import torch
from metric_samples import Sample, by_numpy, random_batch
from torch import Tensor

from normalgan.metrics import (
    MeanAngularError,
    MeanAngularErrorPerImage,
    MeanL1,
    MeanL2,
    MedianAngularError,
    NormalMapMetric,
    RootMeanSquareAngularError,
    ShareBelow,
)

METRICS: dict[str, Callable[..., NormalMapMetric]] = {
    "angular_mean": MeanAngularError,
    "angular_median": MedianAngularError,
    "angular_rmse": RootMeanSquareAngularError,
    "angular_mean_per_image": MeanAngularErrorPerImage,
    "l1": MeanL1,
    "l2": MeanL2,
    "below_7_5": partial(ShareBelow, 7.5),
    "below_30": partial(ShareBelow, 30.0),
}
each_metric = pytest.mark.parametrize("name", METRICS)
BATCHES = [random_batch(seed) for seed in range(4)]


def agrees(name: str, value: Tensor, batches: list[Sample]) -> bool:
    """Whether a value is that of the definition; the median is known to half a bin."""
    exact = by_numpy(batches)[name]
    return value.item() == pytest.approx(exact, abs=0.0051 if name == "angular_median" else 0, rel=1e-5)


def filled(name: str, *batches: Sample) -> NormalMapMetric:
    metric = METRICS[name]()
    for batch in batches:
        metric.update(*batch)
    return metric


@each_metric
@pytest.mark.parametrize("dtype", [torch.float16, torch.bfloat16])
def test_half_precision_loses_what_the_input_lost_and_no_more(name: str, dtype: torch.dtype) -> None:
    halves = [(preds.to(dtype), target.to(dtype), mask) for preds, target, mask in BATCHES]
    value = filled(name, *halves).compute()
    assert value.dtype == torch.float32
    assert agrees(name, value, [(preds.float(), target.float(), mask) for preds, target, mask in halves])


@each_metric
def test_worse_maps_are_worse_in_the_direction_it_tells(name: str) -> None:
    rng = torch.Generator().manual_seed(9)
    worse = [(p + 0.8 * torch.randn(p.shape, generator=rng), t, m) for p, t, m in BATCHES]
    metric = METRICS[name]()
    better, after = filled(name, *BATCHES).compute(), filled(name, *worse).compute()
    assert (after < better) if metric.higher_is_better else (after > better)
