import pytest
import torch

from normalgan.losses import CosineAndL2, Predictions


def test_its_parts_are_the_cosine_on_the_object_and_the_distance_everywhere() -> None:
    target = torch.zeros(1, 3, 1, 2)
    target[0, 2, 0, 0] = 1  # one pixel faces the viewer, the other is off the object
    mask = torch.tensor([1.0, 0.0]).view(1, 1, 1, 2)
    preds = torch.zeros(1, 3, 1, 2)
    preds[0, :, 0, 0] = torch.tensor([0.6, 0.0, 0.8])
    preds[0, :, 0, 1] = torch.tensor([0.0, 1.0, 0.0])
    terms = CosineAndL2(2.0, 3.0).terms(Predictions(preds), target, mask, torch.zeros_like(mask))
    assert terms["cosine"].value.item() == pytest.approx(0.2)
    assert terms["l2"].value.item() == pytest.approx((0.36 + 0.04 + 1) / 2)
    assert (terms["cosine"].weight, terms["l2"].weight) == (2, 3)


def test_its_gradient_is_finite_where_nothing_is_painted() -> None:
    preds = torch.zeros(1, 3, 2, 2, requires_grad=True)
    target = torch.zeros(1, 3, 2, 2)
    target[:, 2] = 1
    mask = torch.ones(1, 1, 2, 2)
    terms = CosineAndL2().terms(Predictions(preds), target, mask, torch.zeros_like(mask))
    sum(term.weight * term.value for term in terms.values()).backward()  # type: ignore[union-attr]
    assert preds.grad is not None
    assert preds.grad.isfinite().all()
    assert (preds.grad[:, 2] < 0).all()
