"""Samplers that give an exact number of points, by what each of them is to maximise."""

from itertools import pairwise

import numpy as np
import pytest
import torch
from hint_scenes import seeded
from torch import Tensor

from normalgan.hints import CurvatureHints, FarthestPointHints, HintSampler, UniformHints, WorstErrorHints

SIZE = 48


def scene() -> tuple[Tensor, Tensor]:
    """Bumpy normals on two discs of unlike sizes."""
    y, x = torch.meshgrid(torch.linspace(-1, 1, SIZE), torch.linspace(-1, 1, SIZE), indexing="ij")
    slopes = torch.stack([0.4 * torch.sin(7 * x + 2 * y), 0.4 * torch.cos(5 * y - 3 * x), torch.ones_like(x)])
    normal = torch.nn.functional.normalize(slopes, dim=0).expand(2, 3, SIZE, SIZE)
    mask = torch.stack([x.square() + y.square() < r**2 for r in (0.9, 0.4)])[:, None].float()
    return normal * mask, mask


@pytest.mark.parametrize("count", [0, 3, 10, 60])
@pytest.mark.parametrize("kind", ["uniform", "curvature", "farthest", "worst"])
def test_every_sample_gets_as_many(kind: str, count: int) -> None:
    samplers: dict[str, HintSampler] = {
        "uniform": UniformHints(count, count),
        "curvature": CurvatureHints(count=count),
        "farthest": FarthestPointHints(count),
        "worst": WorstErrorHints(count),
    }
    normal, mask = scene()
    where = samplers[kind].sample(normal, mask, seeded())
    assert where.sum((1, 2, 3)).tolist() == [count, count]
    assert not (where * (1 - mask)).any()
    mask[1], mask[1, 0, 4, 4:6] = 0, 1  # fewer pixels than hints
    assert samplers[kind].sample(normal * mask, mask, seeded())[1].sum() == min(count, 2)


def test_each_point_is_the_farthest_from_those_before() -> None:
    normal, mask = scene()
    sets = [
        {
            tuple(at)
            for at in torch.nonzero(FarthestPointHints(k).sample(normal, mask, seeded())[0, 0]).tolist()
        }
        for k in range(1, 9)
    ]
    pixels = np.argwhere(mask[0, 0].numpy() > 0)
    for before, after in pairwise(sets):
        (new,) = after - before
        distances = np.linalg.norm(pixels[:, None] - np.array(sorted(before))[None], axis=2).min(1)
        own = min(np.hypot(new[0] - row, new[1] - column) for row, column in before)
        assert own == pytest.approx(distances.max())


def test_the_worst_come_first_and_keep_their_distance() -> None:
    _, mask = scene()
    error = 90 * torch.rand(mask.shape, generator=seeded()) * mask
    worst = WorstErrorHints(12, spacing=0).sample_by_error(error, mask, seeded())
    limit = error.flatten(1).topk(12, dim=1).values[:, -1]
    assert torch.equal(worst > 0, error >= limit.view(-1, 1, 1, 1))
    spaced = WorstErrorHints(12).sample_by_error(error, mask, seeded())
    assert (spaced * (error == error.amax((1, 2, 3), True))).sum((1, 2, 3)).tolist() == [1, 1]
    points = torch.nonzero(spaced[0, 0]).double()
    distances = torch.cdist(points, points) + 1e3 * torch.eye(12, dtype=torch.float64)
    assert distances.min() >= 0.5 * (mask[0].sum() / 12).sqrt()


def test_curvature_at_a_count_takes_the_selected_points_first() -> None:
    normal, mask = scene()
    sampler = CurvatureHints(count=5)
    selected = sampler.select(normal, mask)
    found = int(selected[0].sum())
    assert found > 5
    assert not (sampler.sample(normal, mask, seeded())[0] * ~selected[0]).any()
    more = CurvatureHints(count=found + 40)
    where = more.sample(normal, mask, seeded())[0] > 0
    assert (where & selected[0]).sum() == found
    away = (more.levels(normal)[0] - 127).abs()
    assert away[where].max() <= away[(mask[0] > 0) & ~where].min() + 1  # whole levels, one of them shared
    others = CurvatureHints(count=5).sample(normal, mask, seeded(9))
    assert not torch.equal(others, sampler.sample(normal, mask, seeded()))
