import pytest
import torch
from torch._subclasses import FakeTensorMode

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


def test_hints_by_name_are_drawn_on_the_cpu_whatever_the_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """A GPU draws other numbers from the same seed; here it is one that only says that it is there."""
    places: list[torch.device] = []

    # What is not there has no values to be looked at.
    monkeypatch.setattr("normalgan.hints.draw.check_hint_values", lambda *_: None)

    class Watched(UniformHints):
        def sample(self, normal: torch.Tensor, mask: torch.Tensor, rng: torch.Generator) -> torch.Tensor:
            places.extend([normal.device, mask.device, rng.device])
            return torch.zeros_like(mask)

    with FakeTensorMode(allow_non_fake_inputs=True):
        normal, mask = torch.empty(2, 3, 8, 8, device="cuda"), torch.empty(2, 1, 8, 8, device="cuda")
        hints = draw_hints_by_name(Watched(), normal, mask, NAMES, 0)
    assert {place.type for place in places} == {"cpu"}
    assert hints.device.type == "cuda"
