"""The figures against their definitions, written out in numpy."""

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree

from normalgan.benchmark.accumulator import Accumulator

CPU = torch.device("cpu")
SIZE = 64


@pytest.fixture
def samples() -> tuple[torch.Tensor, ...]:
    """A disc and a smaller one, truth and paint 3 pixels wider, painted with confidence."""
    rng = torch.Generator().manual_seed(1)
    y, x = torch.meshgrid(torch.arange(SIZE) - 31.5, torch.arange(SIZE) - 31.5, indexing="ij")
    radius = (x.square() + y.square()).sqrt()
    mask = torch.stack([radius < 24, radius < 15])[:, None].float()
    target = torch.nn.functional.normalize(torch.randn(2, 3, SIZE, SIZE, generator=rng), dim=1) * mask
    noise = torch.randn(2, 3, SIZE, SIZE, generator=rng)
    predicted = 0.9 * torch.nn.functional.normalize(target + 0.3 * noise, dim=1)
    predicted *= torch.stack([radius < 27, radius < 18])[:, None]
    confidence = 1 + 9 * torch.rand(2, 1, SIZE, SIZE, generator=rng)
    where = (torch.rand(mask.shape, generator=rng) < 0.01) * mask
    return torch.cat([predicted, confidence], dim=1), target, mask, where


@pytest.fixture
def accumulator(samples: tuple[torch.Tensor, ...]) -> Accumulator:
    accumulator = Accumulator(CPU)
    for i, name in enumerate(("a/0", "b/0")):
        predicted, target, mask, where = (each[i : i + 1] for each in samples)
        accumulator.update(predicted, target, mask, where, [name])
    return accumulator


def by_numpy(samples: tuple[torch.Tensor, ...], views: list[int]) -> dict[str, float]:
    predicted, target, mask, where = (each.double().numpy()[views] for each in samples)
    unit = predicted[:, :3] / np.maximum(np.linalg.norm(predicted[:, :3], axis=1, keepdims=True), 1e-12)
    counted = (mask[:, 0] > 0) & (where[:, 0] == 0)
    angle = np.degrees(np.arccos(np.clip((unit * target).sum(1), -1, 1)))
    nz = unit[:, 2] - target[:, 2]
    distance = np.zeros_like(mask[:, 0])
    for k, one in enumerate(mask[:, 0]):
        inside, outside = np.argwhere(one > 0), np.argwhere(one == 0)
        distance[k][tuple(inside.T)] = cKDTree(outside).query(inside)[0] - 0.5
    rim, deep = counted & (distance <= 0.5), counted & (distance > 10 * SIZE / 170)
    changes = [0.0, 0.0]
    for k, normals in enumerate((unit, target)):
        for axis in (1, 2):
            step = np.linalg.norm(np.diff(normals, axis=axis + 1), axis=1)
            both = np.logical_and(*(np.take(counted, range(s, SIZE - 1 + s), axis) for s in (0, 1)))
            changes[k] += step[both].sum()
    shown = np.linalg.norm(predicted[:, :3], axis=1) > 0.5
    return {
        "angular_mean": angle[counted].mean(),
        "nz_bias": nz[counted].mean(),
        "nz_bias_rim": nz[rim].mean(),
        "angular_rim": angle[rim].mean(),
        "angular_deep": angle[deep].mean(),
        "gradient_ratio": changes[0] / changes[1],
        "mask_iou": (shown & (mask[:, 0] > 0)).sum() / (shown | (mask[:, 0] > 0)).sum(),
    }


def test_figures_are_those_of_their_definitions(
    samples: tuple[torch.Tensor, ...], accumulator: Accumulator
) -> None:
    for found, views in (
        (accumulator.figures(), [0, 1]),
        (accumulator.by_mesh()["a"], [0]),
        (accumulator.by_mesh()["b"], [1]),
    ):
        wanted = by_numpy(samples, views)
        assert {name: found[name] for name in wanted} == pytest.approx(wanted, rel=1e-4)
        assert 0.1 < wanted["mask_iou"] < 0.9


def test_errors_by_distance_are_all_errors(accumulator: Accumulator) -> None:
    bins = accumulator.by_distance()["170ths"]
    counts = np.array([one["pixels"] for one in bins], float)
    angles = np.array([one["angular_mean"] for one in bins], float)
    assert counts.sum() == sum(mesh["pixels"] or 0 for mesh in accumulator.by_mesh().values())
    assert (counts * angles).sum() / counts.sum() == pytest.approx(
        accumulator.figures()["angular_mean"], abs=1e-3
    )
    assert bins[0]["from"] == 1  # the outermost of 64 pixels lies 1.3 / 170 inside


def test_the_calibration_curve_is_that_of_the_confidence(
    samples: tuple[torch.Tensor, ...], accumulator: Accumulator
) -> None:
    curve = accumulator.calibration()
    assert curve is not None
    assert sum(point["pixels"] for point in curve) == sum(
        mesh["pixels"] or 0 for mesh in accumulator.by_mesh().values()
    )
    weighted = sum(point["pixels"] * abs(point["observed"] - point["predicted"]) for point in curve)
    error = accumulator.figures()["calibration_error"]
    assert error == pytest.approx(weighted / sum(point["pixels"] for point in curve))
    assert "calibration_error" not in accumulator.by_mesh()["a"]
    bare = Accumulator(CPU)
    predicted, target, mask, where = samples
    bare.update(predicted[:, :3], target, mask, where, ["a/0", "b/0"])
    assert bare.calibration() is None
    assert bare.figures().items() <= accumulator.figures().items()
