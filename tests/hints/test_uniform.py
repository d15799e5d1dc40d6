import pytest
import torch
from hint_scenes import seeded, sphere

from normalgan.errors import InputError
from normalgan.hints import NoHints, UniformHints, hints_at


def test_every_count_between_the_bounds_comes_up_and_no_other() -> None:
    normal, mask = sphere(32, radius=12)
    where = UniformHints(3, 6).sample(normal.expand(400, -1, -1, -1), mask.expand(400, -1, -1, -1), seeded())
    counts = where.sum((1, 2, 3)).long().bincount(minlength=8).tolist()
    assert sum(counts[3:7]) == 400
    assert all(60 < count < 140 for count in counts[3:7])


def test_numbers_even_in_their_logarithm() -> None:
    normal, mask = (each.expand(600, -1, -1, -1) for each in sphere(32, radius=12))
    where = UniformHints(1, 63, numbers="log").sample(normal, mask, seeded())
    counts = where.sum((1, 2, 3))
    assert counts.min() == 1
    assert counts.max() <= 63
    octaves = torch.log2(counts).floor().long().bincount(minlength=6).tolist()
    assert len(octaves) == 6
    assert all(70 < count < 130 for count in octaves)
    with pytest.raises(InputError, match="with numbers: log it is 1 or more"):
        UniformHints(0, 5, numbers="log")


def test_every_pixel_of_the_object_has_an_equal_chance_and_no_other_has_any() -> None:
    normal, mask = sphere(10, radius=4)
    where = UniformHints(5, 5).sample(
        normal.expand(4000, -1, -1, -1), mask.expand(4000, -1, -1, -1), seeded()
    )
    frequency = where.mean(0)[0]
    inside = mask[0, 0] > 0
    chance = 5 / inside.sum().item()
    assert frequency[~inside].eq(0).all()
    assert (frequency[inside] - chance).abs().max() < 5 * (chance * (1 - chance) / 4000) ** 0.5


def test_small_object_is_hinted_everywhere_and_an_empty_one_nowhere() -> None:
    mask = torch.zeros(2, 1, 6, 6)
    mask[0, 0, 2, 1:4] = 1
    where = UniformHints(10, 50).sample(torch.ones(2, 3, 6, 6), mask, seeded())
    assert torch.equal(where, mask)


def test_zero_hints_are_legal() -> None:
    normal, mask = sphere(8, radius=3)
    assert UniformHints(0, 0).sample(normal, mask, seeded()).sum() == 0


def test_bad_bounds_say_what_would_be_right() -> None:
    with pytest.raises(InputError, match="minimum=5 and maximum=4; use a minimum that is not larger"):
        UniformHints(5, 4)


def test_no_hints_gives_none_and_draws_nothing() -> None:
    normal, mask = sphere(16, radius=6)
    rng = seeded()
    before = rng.get_state()
    assert NoHints().sample(normal, mask, rng).sum() == 0
    assert torch.equal(rng.get_state(), before)


def test_hints_are_the_true_normals_where_they_are_and_zero_elsewhere() -> None:
    normal, mask = sphere(16, radius=6)
    where = UniformHints(7, 7).sample(normal, mask, seeded())
    hints = hints_at(normal, where)
    chosen = where[0, 0] > 0
    assert torch.equal(hints[:, 3:], where)
    assert torch.equal(hints[0, :3, chosen], normal[0, :, chosen])
    assert hints[0, :3, ~chosen].eq(0).all()


def test_hints_take_the_normals_type_and_hide_what_is_not_a_number() -> None:
    normal = torch.full((1, 3, 2, 2), float("nan"), dtype=torch.float64)
    normal[..., 0, 0] = 1.0
    where = torch.zeros(1, 1, 2, 2, dtype=torch.bool)
    where[..., 0, 0] = True
    hints = hints_at(normal, where)
    assert hints.dtype == torch.float64
    assert hints.sum() == 4


def test_a_share_of_the_samples_gets_none() -> None:
    normal, mask = torch.zeros(400, 3, 4, 4), torch.ones(400, 1, 4, 4)
    where = UniformHints(2, 5, none=0.25).sample(normal, mask, torch.Generator().manual_seed(0))
    counts = where.sum(dim=(1, 2, 3))
    assert (counts == 0).float().mean() == pytest.approx(0.25, abs=0.06)
    assert set(counts.tolist()) == {0, 2, 3, 4, 5}
