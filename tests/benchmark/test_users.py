"""Hints as people give them: off by an angle or some pixels, placed at equal counts, given one by one."""

from itertools import pairwise

import numpy as np
import pytest
import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.hint_noise import noisy_hints
from normalgan.benchmark.measure import HintTests, measure
from normalgan.benchmark.methods import Method, constant_method
from normalgan.benchmark.pins import STRATEGIES, pin_curve, pin_one_by_one
from normalgan.benchmark.placements import placements
from normalgan.benchmark.points import hint_points
from normalgan.hints import UniformHints, hints_at
from normalgan.metrics import angular_error
from spheres import batch

CPU = torch.device("cpu")
COUNT = 20


def named(size: int = 48) -> Batch:
    return {**batch(size=size), "name": ["a/0", "b/1"]}


@pytest.fixture
def where() -> Tensor:
    given = named()
    return hint_points(given["mask"], given["name"], 0, COUNT)


@pytest.mark.parametrize("degrees", [0.0, 10.0, 30.0])
def test_hints_are_turned_by_exactly_so_much_and_face_the_viewer(where: Tensor, degrees: float) -> None:
    given = named()
    hints = noisy_hints(given["normal"], given["mask"], where, given["name"], 0, degrees, 0)
    assert torch.equal(hints[:, 3:], where)
    found = angular_error(hints[:, :3], given["normal"])[where > 0]
    torch.testing.assert_close(found, torch.full_like(found, degrees), atol=0.01, rtol=0)
    assert hints[:, 2].min() >= 0
    if degrees:
        tangents = (hints[:, :3] - given["normal"])[:, :2].mean((2, 3))
        assert tangents.abs().max() < 0.1 * degrees / 30  # no direction in common


@pytest.mark.parametrize("pixels", [1.0, 3.0, 6.0])
def test_hints_are_moved_on_the_object_and_tell_the_normal_of_where_they_were(
    where: Tensor, pixels: float
) -> None:
    given = named()
    hints = noisy_hints(given["normal"], given["mask"], where, given["name"], 0, 0, pixels)
    assert not (hints[:, 3:] * (1 - given["mask"])).any()
    for told, normal, before in zip(hints.numpy(), given["normal"].numpy(), where.numpy(), strict=True):
        starts = np.argwhere(before[0] > 0)
        for row, column in np.argwhere(told[3] > 0):
            same = [
                at for at in starts if np.allclose(normal[:, at[0], at[1]], told[:3, row, column], atol=1e-5)
            ]
            assert min(abs(np.hypot(*(at - (row, column))) - pixels) for at in same) < 0.75
    assert COUNT / 2 < hints[0, 3].sum() <= COUNT  # two may meet in one pixel


def test_placements_are_measured_at_equal_counts() -> None:
    given = named()
    tests = HintTests([0, 3], placements=placements(["uniform", "curvature", "farthest", "worst"], [3, 10]))
    measured = measure(constant_method(), [given], tests, CPU)
    pixels = given["mask"].sum((1, 2, 3))
    for name in tests.placements:
        count = int(name.partition("-")[2])
        assert measured.views[name]["pixels"] == (pixels - count).int().tolist()
    worst, anywhere = (measured.figures[f"{name}-10"]["angular_mean"] for name in ("worst", "uniform"))
    assert worst is not None
    assert anywhere is not None
    assert worst < anywhere  # what is worst is left out, as it was given away


def test_noise_is_measured_on_the_hints_of_table_1() -> None:
    said: list[Tensor] = []

    def predict(one: Batch, hints: Tensor | None) -> Tensor:
        if hints is not None:
            said.append(hints)
        return one["normal"]

    given = named()
    tests = HintTests([5], noise={"degrees-0": (0.0, 0.0), "degrees-20": (20.0, 0.0)}, noisy=5)
    measure(Method(predict, UniformHints(2, 2)), [given], tests, CPU)
    right = hints_at(given["normal"], hint_points(given["mask"], given["name"], 0, 5))
    by_count = dict(zip(("5", "own", "degrees-0", "degrees-20"), said, strict=True))
    torch.testing.assert_close(by_count["5"], right)
    torch.testing.assert_close(by_count["degrees-0"], right)
    assert torch.equal(by_count["degrees-20"][:, 3:], right[:, 3:])
    assert not torch.allclose(by_count["degrees-20"], right)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_pins_come_one_by_one_and_the_curve_is_over_the_same_pixels(strategy: str) -> None:
    """Facing the viewer until there are three pins, then the truth."""
    given = named()
    numbers: list[int] = []
    places: list[Tensor] = []

    def predict(one: Batch, hints: Tensor | None) -> Tensor:
        number = 0 if hints is None else int(hints[0, 3].sum())
        numbers.append(number)
        if hints is not None:
            places.append(hints[:, 3:])
            torch.testing.assert_close(hints[:, :3], one["normal"] * hints[:, 3:])
        facing = torch.zeros_like(one["normal"])
        facing[:, 2] = 1
        return one["normal"] if number >= 3 else facing

    sums = pin_one_by_one(Method(predict, UniformHints()), given, strategy, 4)  # type: ignore[arg-type]
    assert numbers == [0, 1, 2, 3, 4]
    assert all(((after - before) >= 0).all() for before, after in pairwise(places))
    assert sums[:, -1].tolist() == (given["mask"].sum((1, 2, 3)) - 4).tolist()
    curve = pin_curve([sums[:1], sums[1:]])
    assert curve[0] == curve[1] == curve[2] > 10
    assert curve[3] == curve[4] == pytest.approx(0, abs=0.05)
    if strategy == "worst":  # of what faces the viewer the outline is farthest off
        first = given["normal"][:, 2:][places[0] > 0]
        assert first.max() < 0.5
