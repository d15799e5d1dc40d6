import math

import pytest
import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.losses import CrossEntropy, Wasserstein, WassersteinGradientPenalty, hint_loss, l1_loss
from normalgan.models import UNetDiscriminator


@pytest.mark.parametrize("objective", [Wasserstein(), WassersteinGradientPenalty()])
def test_wasserstein_signs(objective: Wasserstein) -> None:
    real, fake = (torch.tensor([[3.0]]),), (torch.tensor([[1.0]]),)
    assert objective.discriminator_loss(real, fake) == -2  # falls as true maps score higher
    assert objective.generator_loss(fake) == -1  # falls as predicted maps score higher


def test_cross_entropy_at_chance_is_log_two() -> None:
    zero = (torch.zeros(2, 1, 4, 4),)
    assert CrossEntropy().discriminator_loss(zero, zero).item() == pytest.approx(math.log(2))
    assert CrossEntropy().generator_loss(zero).item() == pytest.approx(math.log(2))


def test_clipping_reaches_every_parameter_of_norms_too() -> None:
    critic = UNetDiscriminator(size=16, width=4)
    assert max(p.abs().max() for p in critic.parameters()) > 0.5
    Wasserstein(weight_clip=0.01).after_discriminator_step(critic)
    assert max(p.abs().max() for p in critic.parameters()) <= 0.01


@pytest.mark.parametrize("slope", [0.0, 1.0, 3.0])
def test_gradient_penalty_of_a_linear_critic_is_known(slope: float) -> None:
    direction = torch.randn(3, 4, 4)
    direction *= slope / direction.norm()

    def critic(normal: Tensor) -> tuple[Tensor, ...]:
        return ((normal * direction).sum(dim=(1, 2, 3))[:, None],)

    penalty = WassersteinGradientPenalty(gradient_penalty=10).penalty(
        critic, torch.randn(5, 3, 4, 4), torch.randn(5, 3, 4, 4)
    )
    assert penalty.item() == pytest.approx(10 * (slope - 1) ** 2, rel=1e-4, abs=1e-5)


def test_gradient_penalty_trains_the_critic() -> None:
    critic = nn.Conv2d(3, 1, 3)
    WassersteinGradientPenalty().penalty(
        lambda normal: (critic(normal),), torch.randn(2, 3, 8, 8), torch.randn(2, 3, 8, 8)
    ).backward()
    assert critic.weight.grad is not None
    assert critic.weight.grad.abs().sum() > 0


def test_gradient_penalty_refuses_batch_norm() -> None:
    with pytest.raises(InputError, match="without batch norm; give it norm: instance"):
        WassersteinGradientPenalty().check(UNetDiscriminator(size=16, width=2))
    WassersteinGradientPenalty().check(UNetDiscriminator(size=16, width=2, norm="instance"))


def test_l1_is_a_mean_over_channels() -> None:
    assert (
        l1_loss(torch.zeros(1, 3, 2, 2), torch.tensor([0.5, 0, 1]).view(1, 3, 1, 1).expand(1, 3, 2, 2)) == 0.5
    )


def test_hint_loss_is_a_mean_over_hints() -> None:
    preds, target = torch.zeros(2, 3, 4, 4), torch.ones(2, 3, 4, 4)
    where = torch.zeros(2, 1, 4, 4)
    where[0, 0, 1, 1] = where[1, 0, 2, 3] = 1
    assert hint_loss(preds, target, where) == 3
    target[:, :, 0, 0] = 100  # not hinted: does not matter
    assert hint_loss(preds, target, where) == 3
    assert hint_loss(preds, target, torch.zeros_like(where)) == 0


def test_hint_loss_taken_after_pasting_would_be_nothing() -> None:
    preds, target = torch.zeros(1, 3, 4, 4), torch.ones(1, 3, 4, 4)
    where = torch.ones(1, 1, 4, 4)
    assert hint_loss(preds * (1 - where) + target * where, target, where) == 0
