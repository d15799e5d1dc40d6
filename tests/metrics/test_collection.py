import math
from typing import Any
from unittest import mock

import pytest
import torch
from metric_samples import by_numpy, computed, random_batch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.metrics import (
    MapMetric,
    MeanAngularError,
    ShareBelow,
    StageMetrics,
    angular_error,
    normal_map_metrics,
)

NAMES = {
    *("angular_mean", "angular_median", "angular_rmse", "angular_mean_per_image", "l1", "l2"),
    *("below_5", "below_7_5", "below_11_25", "below_22_5", "below_30"),
}


def test_all_metrics_are_numpys() -> None:
    batches = [random_batch(0), random_batch(1), random_batch(2)]
    metrics = normal_map_metrics()
    for batch in batches:
        metrics.update(*batch)
    result, expected = computed(metrics), by_numpy(batches)
    assert set(result) == NAMES
    assert result.pop("angular_median") == pytest.approx(expected.pop("angular_median"), abs=0.0051)
    assert result == pytest.approx(expected, rel=1e-5)


def test_collection_updates_once_from_the_first_batch_on() -> None:
    metrics = normal_map_metrics("val/")
    assert len(metrics.compute_groups) == 1
    with mock.patch("normalgan.metrics.base.angular_error", wraps=angular_error) as counted:
        metrics.update(*random_batch(0))
        metrics.update(*random_batch(1))
    assert counted.call_count == 2
    alone = MeanAngularError()
    alone.update(*random_batch(0))
    alone.update(*random_batch(1))
    assert metrics.compute()["val/angular_mean"] == alone.compute()


def test_keys_take_the_prefix_and_have_no_dots() -> None:
    names = {str(name) for name in normal_map_metrics("test/")}
    assert names == {f"test/{name}" for name in NAMES}
    assert not any("." in name for name in names)


def test_nothing_at_all_is_nan() -> None:
    metrics = normal_map_metrics()
    preds, target, mask = random_batch(0)
    metrics.update(preds, target, 0 * mask)
    assert all(math.isnan(value) for value in computed(metrics).values())
    with pytest.warns(UserWarning, match="called before the ``update``"):
        assert math.isnan(MeanAngularError().compute())


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_prediction_that_is_not_finite_spoils_every_metric(bad: float) -> None:
    preds, target, mask = random_batch(0)
    mask[0, 0, 0, 0] = 1
    preds[0, 1, 0, 0] = bad
    metrics = normal_map_metrics()
    metrics.update(preds, target, mask)
    assert all(math.isnan(value) for value in computed(metrics).values())


def test_casting_the_module_changes_no_sum() -> None:
    metrics = normal_map_metrics()
    module = torch.nn.Module()
    module.add_module("metrics", metrics)
    metrics.update(*random_batch(0))
    module.to(torch.bfloat16)  # as Lightning does under `bf16-true`
    metrics.update(*random_batch(1))
    expected = by_numpy([random_batch(0), random_batch(1)])
    assert computed(metrics)["angular_mean"] == pytest.approx(expected["angular_mean"], rel=1e-5)
    assert computed(metrics)["l2"] == pytest.approx(expected["l2"], rel=1e-5)


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float64, torch.int64])
def test_types_of_input(dtype: torch.dtype) -> None:
    preds = torch.tensor([1.0, 0.0, 0.0]).view(1, 3, 1, 1).expand(1, 3, 2, 2).to(dtype)
    target = torch.tensor([0.0, 1.0, 0.0]).view(1, 3, 1, 1).expand(1, 3, 2, 2).to(dtype)
    metrics = normal_map_metrics()
    metrics.update(preds, target, torch.ones(1, 1, 2, 2, dtype=dtype))
    assert computed(metrics)["angular_mean"] == pytest.approx(90.0)
    assert computed(metrics)["l2"] == pytest.approx(2**0.5)
    assert all(value.dtype == torch.float32 for value in metrics.compute().values())


class Odd(MapMetric):
    """Computes whatever it is told to."""

    label, unit = "odd", "°"

    def __init__(self, figure: Any) -> None:
        super().__init__()
        self.computed = figure

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count nothing."""

    def compute(self) -> Tensor:
        """Return what it was told to."""
        figure: Tensor = self.computed
        return figure


@pytest.mark.parametrize(
    ("figure", "sentence"),
    [
        (None, r"^Odd gave None; a metric computes a tensor of one number\.$"),
        (torch.ones(3), r"^Odd gave a tensor \(3,\); a metric computes a tensor of one number\.$"),
    ],
)
@pytest.mark.filterwarnings("ignore:The ``compute`` method of metric Odd")
def test_a_metric_that_computes_no_number_is_named(figure: Any, sentence: str) -> None:
    stage = StageMetrics("test", ("hints",), [Odd(figure)])
    stage.update("hints", torch.zeros(1, 3, 2, 2), torch.zeros(1, 3, 2, 2), torch.ones(1, 1, 2, 2))
    with pytest.raises(InputError, match=sentence):
        stage.pop()


@pytest.mark.parametrize("more", [[ShareBelow(5.0)], [ShareBelow(3.0), ShareBelow(3.0)]])
def test_two_metrics_of_one_name_are_refused(more: list[MapMetric]) -> None:
    with pytest.raises(InputError, match=r"two metrics are called below_\d, one of them ShareBelow; leave"):
        normal_map_metrics(more=more)
