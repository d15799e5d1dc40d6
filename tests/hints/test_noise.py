import torch
from hint_scenes import sphere

from normalgan.hints import UniformHints, hints_at
from normalgan.hints.noise import perturb_hints


def test_hints_are_turned_by_as_much_as_is_asked_for_and_stay_in_place() -> None:
    normal, mask = (each.expand(300, -1, -1, -1) for each in sphere(16, radius=7))
    hints = hints_at(normal, UniformHints(60, 60).sample(normal, mask, torch.Generator().manual_seed(0)))
    turned = perturb_hints(hints, 20.0, seed=5)
    assert torch.equal(turned[:, 3:], hints[:, 3:])
    assert (turned[:, :3] * (1 - hints[:, 3:])).eq(0).all()
    on = hints[:, 3] > 0
    cosine = (turned[:, :3] * hints[:, :3]).sum(1)
    torch.testing.assert_close(turned[:, :3].norm(dim=1)[on], torch.ones(int(on.sum())))
    angles = torch.rad2deg(torch.acos(cosine.clamp(-1, 1)))
    each = torch.stack([angle[where].mean() for angle, where in zip(angles, on, strict=True)])
    assert 9 < each.mean() < 11  # between none and 20°
    assert 17 < each.quantile(0.95) < 22
    assert torch.equal(turned, perturb_hints(hints, 20.0, seed=5))
    assert not torch.equal(turned, perturb_hints(hints, 20.0, seed=6))
