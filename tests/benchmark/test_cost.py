import pytest
import torch
from torch import nn

from normalgan.batch import Batch
from normalgan.benchmark import cost
from normalgan.benchmark.methods import constant_method


def test_flops_of_a_convolution_are_two_a_weight_and_pixel() -> None:
    network = nn.Conv2d(4, 5, 3, padding=1, bias=False)
    assert cost.flops(network, 16, torch.device("cpu")) == 2 * 16 * 16 * 4 * 5 * 9


def test_maps_a_second_are_those_of_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, 0.4, 0.8, 1.6])
    monkeypatch.setattr(cost, "perf_counter", lambda: next(times))
    zeros = torch.zeros(6, 3, 4, 4)
    batch: Batch = {"sketch": zeros[:, :1], "normal": zeros, "mask": zeros[:, :1]}
    speed = cost.images_per_second(constant_method(), batch, torch.device("cpu"))
    assert speed == pytest.approx(3 * 6 / 1.6)
