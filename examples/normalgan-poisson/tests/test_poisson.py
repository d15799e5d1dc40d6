"""Tests what only this sampler promises: distance, density, no gaps."""

import pytest
import torch
from normalgan_poisson import PoissonHints
from normalgan_poisson.darts import throw_darts
from torch import Tensor

from normalgan.errors import InputError
from normalgan.testing import check


def sample(sampler: PoissonHints, mask: Tensor, seed: int = 0) -> Tensor:
    normal = torch.zeros(len(mask), 3, *mask.shape[2:])
    return sampler.sample(normal, mask, torch.Generator().manual_seed(seed))


def disc(size: int, radius: float) -> Tensor:
    along = torch.arange(size) + 0.5 - size / 2
    return (along[:, None] ** 2 + along**2 < radius**2).float()[None, None]


def thrown_one_by_one(candidates: Tensor, priority: Tensor, distance: float) -> Tensor:
    """Return the same set as the definition gives it: darts in the order of priority."""
    places = candidates[0].nonzero().float()
    order = priority[candidates].argsort(descending=True)
    kept: list[Tensor] = []
    for place in places[order]:
        if all(float((place - other).norm()) >= distance for other in kept):
            kept.append(place)
    landed = torch.zeros_like(candidates)
    for row, column in torch.stack(kept).long():
        landed[0, row, column] = True
    return landed


@pytest.mark.parametrize("distance", [2.0, 3.0, 4.7, 9.0])
def test_it_is_dart_throwing(distance: float) -> None:
    candidates = disc(24, 10)[0] > 0.5
    priority = torch.rand(candidates.shape, generator=torch.Generator().manual_seed(1))
    expected = thrown_one_by_one(candidates, priority, distance)
    assert torch.equal(throw_darts(candidates, priority, distance), expected)
    # Next to pictures with fewer points or none: a finished picture does not disturb the others.
    batch = torch.cat([candidates, torch.zeros_like(candidates), candidates])
    both = throw_darts(batch, priority.expand(3, -1, -1), distance)
    assert torch.equal(both, torch.cat([expected, torch.zeros_like(expected), expected]))


@pytest.mark.parametrize("distance", [3.0, 8.0, 16.0])
def test_no_two_are_close_and_nowhere_does_another_fit(distance: float) -> None:
    mask = disc(96, 40)
    points = sample(PoissonHints(distance), mask)[0, 0].nonzero().double()
    apart = torch.cdist(points, points) + 1e9 * torch.eye(len(points))
    assert apart.min() >= distance
    assert torch.cdist(mask[0, 0].nonzero().double(), points).min(1).values.max() < distance


def test_as_many_as_theory_says() -> None:
    # Disks thrown at random until none fits cover 0.547 of a plane (Feder, "Random Sequential Adsorption",
    # Journal of Theoretical Biology 87, 1980); those cut by the frame make it a little more.
    count = int(sample(PoissonHints(12), torch.ones(2, 1, 256, 256)).sum()) / 2
    assert 0.547 < count * torch.pi * 6**2 / 256**2 < 0.60


def test_every_pixel_has_about_the_same_chance() -> None:
    inner = sample(PoissonHints(3), torch.ones(8000, 1, 12, 12)).mean(0)[0, 4:8, 4:8]
    assert inner.max() / inner.min() < 1.3


def test_points_are_dropped_as_asked() -> None:
    mask = disc(128, 60)
    full, half, none = (sample(PoissonHints(4, keep), mask) for keep in (1.0, 0.5, 0.0))
    assert none.sum() == 0
    assert (half <= full).all()  # a subset of the same points
    assert half.sum() / full.sum() == pytest.approx(0.5, abs=0.1)


def test_seed_decides() -> None:
    mask = disc(64, 28)
    assert torch.equal(sample(PoissonHints(5), mask, 1), sample(PoissonHints(5), mask, 1))
    assert not torch.equal(sample(PoissonHints(5), mask, 1), sample(PoissonHints(5), mask, 2))


@pytest.mark.parametrize(
    ("settings", "answer"),
    [
        ({"distance": 1.5}, "distance=1.5; use 2 to 256 pixels"),
        ({"distance": float("nan")}, "distance=nan; use 2 to 256"),
        ({"keep": 1.5}, "keep=1.5; it is a share, from 0 to 1"),
    ],
)
def test_a_bad_setting_is_one_sentence(settings: dict[str, float], answer: str) -> None:
    with pytest.raises(InputError, match=answer):
        PoissonHints(**settings)


def test_the_whole_kit_in_one_call() -> None:
    check(PoissonHints(6))
