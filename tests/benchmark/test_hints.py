"""Hints of a test: the same points for all, placements at equal counts, hints off as people give them."""

import numpy as np
import pytest
import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.hints import hint_order, hint_points, noisy_hints, placements
from normalgan.benchmark.measure import HintTests, measure
from normalgan.benchmark.methods import Method, constant_method
from normalgan.hints import UniformHints, hints_at
from normalgan.metrics import angular_error
from spheres import batch

MASK = torch.zeros(2, 1, 16, 16)
MASK[0, 0, 3:13, 4:12] = 1
MASK[1, 0, 8, 2:5] = 1  # three pixels
NAMES = ["cat/0", "cat/1"]
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


@pytest.mark.slow
def test_placements_are_measured_at_equal_counts() -> None:
    given = named()
    tests = HintTests([0, 3], placements=placements(["uniform", "curvature", "farthest", "worst"], [3, 10]))
    measured = measure(constant_method(), [given], tests, CPU)
    pixels = given["mask"].sum((1, 2, 3))
    for name in tests.placements:
        count = int(name.partition("-")[2])
        assert sum(mesh["pixels"] or 0 for mesh in measured.meshes[name].values()) == int(
            (pixels - count).sum()
        )
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


def test_a_larger_set_of_hints_contains_the_smaller_one() -> None:
    order = hint_order(MASK[0], "cat/0", 0, 50)
    for count in (0, 5, 10, 20, 50):
        assert hint_order(MASK[0], "cat/0", 0, count).tolist() == order[:count].tolist()
        assert (hint_points(MASK, NAMES, 0, count) <= hint_points(MASK, NAMES, 0, count + 3)).all()


def test_as_many_hints_as_requested_lie_on_the_object() -> None:
    where = hint_points(MASK, NAMES, 0, 10)
    assert (where <= MASK).all()
    assert where.sum((1, 2, 3)).tolist() == [10, 3]
    assert not hint_points(MASK, NAMES, 0, 0).any()


def test_hints_depend_on_name_and_seed_and_not_on_the_batch() -> None:
    where = hint_points(MASK, NAMES, 0, 10)
    assert torch.equal(hint_points(MASK[:1], NAMES[:1], 0, 10), where[:1])
    assert not torch.equal(hint_points(MASK[:1], ["dog/0"], 0, 10), where[:1])
    assert not torch.equal(hint_points(MASK[:1], NAMES[:1], 1, 10), where[:1])
