import torch

from normalgan.benchmark.points import hint_order, hint_points

MASK = torch.zeros(2, 1, 16, 16)
MASK[0, 0, 3:13, 4:12] = 1
MASK[1, 0, 8, 2:5] = 1  # three pixels
NAMES = ["cat/0", "cat/1"]


def test_more_hints_are_the_same_ones_and_others() -> None:
    order = hint_order(MASK[0], "cat/0", 0, 50)
    for count in (0, 5, 10, 20, 50):
        assert hint_order(MASK[0], "cat/0", 0, count).tolist() == order[:count].tolist()
        assert (hint_points(MASK, NAMES, 0, count) <= hint_points(MASK, NAMES, 0, count + 3)).all()


def test_they_lie_on_the_object_as_many_as_asked_for() -> None:
    where = hint_points(MASK, NAMES, 0, 10)
    assert (where <= MASK).all()
    assert where.sum((1, 2, 3)).tolist() == [10, 3]
    assert not hint_points(MASK, NAMES, 0, 0).any()


def test_they_depend_on_the_name_and_the_seed_and_not_on_the_batch() -> None:
    where = hint_points(MASK, NAMES, 0, 10)
    assert torch.equal(hint_points(MASK[:1], NAMES[:1], 0, 10), where[:1])
    assert not torch.equal(hint_points(MASK[:1], ["dog/0"], 0, 10), where[:1])
    assert not torch.equal(hint_points(MASK[:1], NAMES[:1], 1, 10), where[:1])


def test_they_are_uniform() -> None:
    total = sum(hint_points(MASK[:1], [str(i)], 0, 8) for i in range(1000))
    assert isinstance(total, torch.Tensor)
    counts = total[MASK[:1] > 0]
    # Each of 80 pixels is one of the 8 with p = 0.1: 100 ± 9.5 times.
    assert abs(counts.mean().item() - 100) < 1e-3
    assert 7 < counts.std().item() < 12
