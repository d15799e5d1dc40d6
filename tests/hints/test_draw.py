import torch

from normalgan.hints import UniformHints
from normalgan.hints.draw import draw_hints, draw_hints_by_name
from spheres import batch

NAMES = ["a/0", "a/1"]


def test_hints_carry_the_true_normals_of_where_they_are() -> None:
    given = batch()
    hints = draw_hints(UniformHints(5, 5), given["normal"], given["mask"], 0)
    assert hints[:, 3].sum(dim=(1, 2)).tolist() == [5, 5]
    torch.testing.assert_close(hints[:, :3], given["normal"] * hints[:, 3:])


def test_a_sample_gets_the_same_hints_in_any_batch() -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    sampler = UniformHints(5, 9)
    both = draw_hints_by_name(sampler, normal, mask, NAMES, 0)
    turned = draw_hints_by_name(sampler, normal.flip(0), mask.flip(0), NAMES[::-1], 0)
    alone = draw_hints_by_name(sampler, normal[1:], mask[1:], NAMES[1:], 0)
    assert torch.equal(both, turned.flip(0))
    assert torch.equal(both[1:], alone)
    assert not torch.equal(both, draw_hints_by_name(sampler, normal, mask, NAMES, 1))
