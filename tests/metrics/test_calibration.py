import math

import pytest
import torch

from normalgan.losses.angular_likelihood import angular_nll
from normalgan.metrics.calibration import Calibration, expected_angle


@pytest.mark.parametrize("kappa", [0.01, 1.0, 3.0, 30.0])
def test_the_promised_error_is_the_mean_under_the_loss_own_density(kappa: float) -> None:
    theta = torch.linspace(0, math.pi, 200_001, dtype=torch.float64)
    density = torch.exp(-angular_nll(theta, torch.full_like(theta, kappa))) * theta.sin()
    mean = torch.trapezoid(theta * density, theta) / torch.trapezoid(density, theta)
    assert expected_angle(torch.tensor(kappa)).item() == pytest.approx(math.degrees(mean), rel=1e-5)


def test_a_promise_that_is_kept_has_no_error_and_one_that_is_not_has_its_size() -> None:
    predicted = torch.tensor([3.0, 3.0, 21.0, 21.0]).view(1, 1, 1, 4)
    mask = torch.ones_like(predicted)
    kept, broken = Calibration(), Calibration()
    kept.update(predicted, torch.tensor([2.0, 4.0, 11.0, 31.0]).view(1, 1, 1, 4), mask)
    assert kept.error() == pytest.approx(0)
    assert [point["pixels"] for point in kept.curve()] == [2, 2]
    broken.update(predicted, predicted + torch.tensor([1.0, 1.0, -5.0, -5.0]).view(1, 1, 1, 4), mask)
    assert broken.error() == pytest.approx(3)
    assert math.isnan(Calibration().error())
