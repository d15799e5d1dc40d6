import math

import pytest
import torch
from torch import Tensor

from normalgan.errors import InputError
from normalgan.losses import AngularLikelihood, L1AndHints, Predictions
from normalgan.losses.angular_likelihood import angular_nll, relief_error, smooth_angle
from spheres import batch


def predicted(direction: Tensor, probability: float, confidence: float) -> Predictions:
    one = torch.ones_like(direction[:, :1])
    return Predictions(direction, torch.logit(probability * one), confidence * one)


def test_l1_and_hints_are_weighted_apart() -> None:
    given = batch()
    where = torch.zeros_like(given["mask"])
    where[:, :, 16, 16] = 1
    preds = Predictions(torch.zeros_like(given["normal"]))
    terms = L1AndHints(7, 3).terms(preds, given["normal"], given["mask"], where)
    assert {name: term.weight for name, term in terms.items()} == {"l1": 7, "hint": 3}
    torch.testing.assert_close(terms["l1"].value, given["normal"].abs().mean())
    torch.testing.assert_close(terms["hint"].value, given["normal"][:, :, 16, 16].abs().sum(1).mean())


def test_on_the_composited_map_l1_is_0_at_the_hints_and_the_hint_loss_stays() -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    where = torch.zeros_like(mask)
    where[:, :, 14:18, 16] = 1
    preds = torch.full_like(normal, 0.25).requires_grad_()
    raw, composited = (
        L1AndHints(composited=c).terms(Predictions(preds), normal, mask, where) for c in (False, True)
    )
    outside = (0.25 - normal).abs() * (1 - where)  # independent of how the map is composited
    torch.testing.assert_close(composited["l1"].value, outside.sum() / normal.numel())
    assert composited["l1"].value < raw["l1"].value
    assert composited["hint"].value == raw["hint"].value > 0
    (gradient,) = torch.autograd.grad(composited["l1"].value, preds)
    assert not (gradient * where).any()
    assert (gradient * (1 - where)).any()


@pytest.mark.parametrize("confidence", [0.5, 3.0, 40.0])
def test_the_likelihood_is_a_density_over_the_sphere(confidence: float) -> None:
    """∫ exp(-nll) dω is the same for every κ: what is left out is a constant."""
    angle = torch.linspace(0, math.pi, 20001, dtype=torch.float64)
    density = torch.exp(-angular_nll(angle, torch.full_like(angle, confidence)))
    assert torch.trapezoid(2 * math.pi * density * angle.sin(), angle) == pytest.approx(2 * math.pi, rel=1e-4)


def test_the_best_confidence_falls_with_the_error() -> None:
    kappa = torch.linspace(0.1, 200, 20000)
    best = [float(kappa[angular_nll(torch.tensor(angle), kappa).argmin()]) for angle in (0.02, 0.1, 0.5)]
    assert best[0] > best[1] > best[2]
    assert best[1] == pytest.approx(2 / 0.1, rel=0.05)  # 2κ / (κ² + 1) = θ, for large κ


def test_angles_have_a_gradient_even_where_they_are_0() -> None:
    one = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1).requires_grad_()
    other = torch.tensor([0.0, 0.6, 0.8]).view(1, 3, 1, 1)
    angle = smooth_angle(one, other)
    assert angle.item() == pytest.approx(math.atan2(0.6, 0.8), abs=1e-4)
    smooth_angle(one, one.detach()).sum().backward()
    assert one.grad is not None
    assert one.grad.isfinite().all()


def test_the_truth_told_surely_costs_least() -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    where = torch.zeros_like(mask)

    def loss(preds: Predictions) -> float:
        terms = AngularLikelihood().terms(preds, normal, mask, where)
        return float(sum(term.weight * term.value for term in terms.values()))

    flat = torch.zeros_like(normal)
    flat[:, 2] = 1
    everywhere = predicted(normal * mask + flat * (1 - mask), 0.99, 50)
    sure = loss(everywhere._replace(presence=torch.logit(0.98 * mask + 0.01)))
    others = [loss(predicted(direction, 0.99, 5)) for direction in (everywhere.direction, flat, -flat)]
    assert [sure, *others] == sorted([sure, *others])
    on, off = (loss(predicted(everywhere.direction, probability, 5)) for probability in (0.9, 0.1))
    share = float(mask.mean())
    assert (on < off) == (share > 0.5)


@pytest.mark.parametrize("weight", [0.0, 3.0])
def test_directions_learn_from_the_likelihood_or_from_the_angle_alone(weight: float) -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    flat = torch.zeros_like(normal)
    flat[:, 2] = 0.9

    def gradients(confidence: float) -> tuple[Tensor, Tensor]:
        preds = predicted(flat.clone().requires_grad_(), 0.9, confidence)
        assert preds.confidence is not None
        kappa = preds.confidence.requires_grad_()
        terms = AngularLikelihood(0.0, weight).terms(preds, normal, mask, torch.zeros_like(mask))
        torch.stack([term.weight * term.value for term in terms.values()]).sum().backward()
        assert preds.direction.grad is not None
        assert kappa.grad is not None
        return preds.direction.grad, kappa.grad

    (sure, of_sure), (unsure, of_unsure) = gradients(8.0), gradients(2.0)
    torch.testing.assert_close(sure, unsure if weight else 4 * unsure)
    assert not torch.equal(of_sure, of_unsure)  # the confidence learns in either way


def test_a_generator_without_confidence_is_refused() -> None:
    given = batch()
    preds = Predictions(given["normal"])
    with pytest.raises(
        InputError, match="ResidualUNetGenerator; this one gives no presence and no confidence"
    ):
        AngularLikelihood().terms(preds, given["normal"], given["mask"], given["mask"])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"l1_weight": -1}, "l1_weight of L1AndHints is -1"),
        ({"hint_weight": -1}, "hint_weight of L1AndHints is -1"),
    ],
)
def test_negative_weights_are_refused(settings: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        L1AndHints(**settings)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="presence_weight of AngularLikelihood is -1"):
        AngularLikelihood(presence_weight=-1)
    with pytest.raises(InputError, match="angle_weight of AngularLikelihood is -2"):
        AngularLikelihood(angle_weight=-2)


def test_relief_is_the_mean_n_z_of_parts() -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    assert float(relief_error(normal, normal, mask)) == 0
    mirrored = normal * torch.tensor([-1.0, -1.0, 1.0]).view(1, 3, 1, 1)
    assert float(relief_error(mirrored, normal, mask)) == 0  # directions are for the other terms
    flat = torch.zeros_like(normal)
    flat[:, 2] = 1
    expected = float(((1 - normal[:, 2:]) * mask).sum() / mask.sum())
    torch.testing.assert_close(float(relief_error(flat, normal, mask)), expected)


def test_a_stride_compares_one_pixel_of_each_square() -> None:
    given = batch()
    normal, mask = given["normal"], given["mask"]
    logit = (20 * (2 * mask - 1)).requires_grad_()
    direction = torch.nn.functional.normalize(normal + 0.3, dim=1).requires_grad_()
    preds = Predictions(direction, logit, torch.full_like(mask, 5.0))
    values = []
    for seed in range(40):
        torch.manual_seed(seed)
        terms = AngularLikelihood(angle_weight=1.0, stride=2).terms(preds, normal, mask, mask)
        values.append(terms["angle"].value.item())
    terms["angle"].value.backward()
    assert direction.grad is not None
    felt = direction.grad.abs().sum((0, 1)) > 0
    assert {(int(y) % 2, int(x) % 2) for y, x in felt.nonzero()} == {tuple((felt.nonzero()[0] % 2).tolist())}
    whole = AngularLikelihood(angle_weight=1.0).terms(preds, normal, mask, mask)["angle"].value.item()
    assert len(set(values)) == 4
    assert abs(sum(values) / len(values) - whole) < 0.03
