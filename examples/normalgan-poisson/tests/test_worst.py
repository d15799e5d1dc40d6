"""Tests what only this metric promises."""

import pytest
import torch
from normalgan_poisson import WorstPicture


def tilted(degrees: list[float]) -> torch.Tensor:
    angle = torch.deg2rad(torch.tensor(degrees))
    vectors = torch.stack([angle.sin(), torch.zeros_like(angle), angle.cos()], dim=1)
    return vectors[..., None, None].expand(-1, 3, 8, 8)


def test_it_is_the_mean_angle_of_the_worst_picture() -> None:
    metric = WorstPicture()
    mask = torch.ones(2, 1, 8, 8)
    metric.update(tilted([10.0, 30.0]), tilted([0.0, 0.0]), mask)
    metric.update(tilted([20.0, 5.0]), tilted([0.0, 0.0]), mask)
    assert float(metric.compute()) == pytest.approx(30.0, abs=1e-3)
    assert (metric.figure, metric.unit) == ("worst_picture", "°")


def test_of_no_picture_it_is_nan() -> None:
    metric = WorstPicture()
    metric.update(tilted([10.0]), tilted([0.0]), torch.zeros(1, 1, 8, 8))
    assert metric.compute().isnan()
