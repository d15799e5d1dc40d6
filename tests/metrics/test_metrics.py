import math
from unittest import mock

import numpy as np
import pytest
import torch
from metric_samples import computed, random_batch, turned

from normalgan.errors import InputError
from normalgan.metrics import MeanAngularError, MedianAngularError, ShareBelow, normal_map_metrics


def test_bounds_of_shares_are_strict() -> None:
    with mock.patch("normalgan.metrics.base.angular_error") as error:
        # Just below, on, and just above; what the float32 neighbours of the usual thresholds become.
        for threshold in (5.0, 7.5, 11.25, 22.5, 30.0):
            metric = ShareBelow(threshold)
            on = torch.tensor(threshold)
            below, above = (torch.nextafter(on, torch.tensor(end)) for end in (0.0, 180.0))
            for angle, expected in ((below, 1.0), (on, 0.0), (above, 0.0)):
                error.return_value = angle.view(1, 1, 1, 1)
                metric.reset()
                metric.update(torch.ones(1, 3, 1, 1), torch.ones(1, 3, 1, 1), torch.ones(1, 1, 1, 1))
                assert metric.compute().item() == expected, (threshold, angle)


@pytest.mark.parametrize("degrees", [[10.0], [3.0, 1.0, 2.0], [1.0, 2.0, 60.0, 170.0], [180.0, 180.0], [0.0]])
def test_median_of_odd_and_even_numbers(degrees: list[float]) -> None:
    metric = MedianAngularError()
    metric.update(*turned(degrees))
    assert metric.compute().item() == pytest.approx(float(np.median(degrees)), abs=0.0051)


def test_pooled_mean_weighs_pixels_and_the_other_weighs_images() -> None:
    metrics = normal_map_metrics()
    metrics.update(*turned([10.0, 10.0, 10.0]))
    metrics.update(*turned([50.0]))
    assert computed(metrics)["angular_mean"] == pytest.approx(20.0)
    assert computed(metrics)["angular_mean_per_image"] == pytest.approx(30.0)


def test_long_runs_lose_nothing() -> None:
    metric = MeanAngularError()
    metric.update(*turned([30.0] * 1000))
    state = {name: torch.as_tensor(value) * 1_000_000 for name, value in metric.metric_state.items()}
    metric.merge_state(state)  # 10⁹ pixels
    metric.update(*turned([0.0] * 1000))
    assert metric.angle_sum == state["angle_sum"] + state["angle_sum"] // 1_000_000
    assert metric.compute().item() == pytest.approx(30.0 * 1_000_001 / 1_000_002, rel=2e-7)


@pytest.mark.parametrize("threshold", [0.0, -5.0, 180.0, 11.255, math.nan])
def test_bad_threshold_says_what_would_be_right(threshold: float) -> None:
    with pytest.raises(InputError, match="use degrees between 0 and 180 with at most two decimals"):
        ShareBelow(threshold)


def test_mask_without_a_channel_is_told() -> None:
    preds, target, mask = random_batch(0)
    with pytest.raises(InputError, match=r"mask has the shape \(4, 24, 24\); it must be \(4, 1, 24, 24\)"):
        MeanAngularError().update(preds, target, mask[:, 0])
