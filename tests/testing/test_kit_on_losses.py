from dataclasses import dataclass
from typing import Any

import pytest
import torch
from torch import Tensor, nn

from normalgan.losses import AdversarialObjective, Critic, Predictions, Reconstruction, Scores, Term
from normalgan.testing import ConformanceError, check


class Plain(AdversarialObjective):
    """Means of scores, a head as much as another."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Any:
        return self.generator_loss(real) - self.generator_loss(fake)

    def generator_loss(self, fake: Scores) -> Any:
        return -torch.stack([score.mean() for score in fake]).mean()


class Vector(Plain):
    """Returns a loss a head."""

    def generator_loss(self, fake: Scores) -> Any:
        return -torch.stack([score.mean() for score in fake])


class Number(Plain):
    """Returns a number of Python."""

    def generator_loss(self, fake: Scores) -> Any:
        return super().generator_loss(fake).item()


class Infinite(Plain):
    """Divides by nothing."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Any:
        return super().discriminator_loss(real, fake) / 0


class Detached(Plain):
    """Cuts the gradient off."""

    def generator_loss(self, fake: Scores) -> Any:
        return super().generator_loss(fake).detach()


class UpsideDown(Plain):
    """Takes low scores for true."""

    def generator_loss(self, fake: Scores) -> Any:
        return -super().generator_loss(fake)


class Mirrored(Plain):
    """Mixes up the discriminator's scores."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Any:
        return super().discriminator_loss(fake, real)


class HalfBlind(Plain):
    """Forgets the painted maps."""

    def discriminator_loss(self, real: Scores, fake: Scores) -> Any:
        return self.generator_loss(real)


class Pooled(Plain):
    """Counts elements, not heads."""

    def generator_loss(self, fake: Scores) -> Any:
        return -torch.cat([score.flatten() for score in fake]).mean()


class OtherDice(Plain):
    """Draws from a state of its own."""

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        own = torch.Generator()
        own.seed()
        return critic(real)[0].mean() * torch.rand((), generator=own)


class Fixed(Plain):
    """Punishes the critic for what it cannot help."""

    def penalty(self, critic: Critic, real: Tensor, fake: Tensor) -> Tensor:
        return real.new_ones(())


class Spoils(Plain):
    """Divides weights by nothing."""

    @torch.no_grad()
    def after_discriminator_step(self, discriminator: nn.Module) -> None:
        for parameter in discriminator.parameters():
            parameter.div_(0)


class Rude(Plain):
    """Refuses with something else than InputError."""

    def check(self, discriminator: nn.Module) -> None:
        raise KeyError("norm")


OBJECTIVE_FAULTS = [
    (Vector, r"Vector returned \(2,\) as generator_loss; generator_loss must be a scalar"),
    (Number, "Number returned float as generator_loss; generator_loss must be a scalar"),
    (Infinite, "Infinite returned (nan|-?inf) as discriminator_loss; discriminator_loss must be finite"),
    (Detached, "Detached returned a generator_loss without a gradient; both losses"),
    (UpsideDown, "UpsideDown does not lower generator_loss as scores rise; the generator wants"),
    (
        Mirrored,
        "Mirrored does not lower discriminator_loss as true maps score higher; the discriminator wants",
    ),
    (HalfBlind, "HalfBlind does not raise discriminator_loss as predicted maps score higher"),
    (Pooled, "Pooled weighs a head of 16 scores and a head of one as .*; heads count equally"),
    (
        OtherDice,
        "OtherDice returned two penalties under one seed of torch; draw random numbers by torch alone",
    ),
    (Fixed, "Fixed returned a penalty without a gradient; it must teach the critic something"),
    (Spoils, "Spoils spoilt patches.weight of the discriminator; after_discriminator_step may change"),
    (Rude, "Rude raised KeyError .* when asked for refusing with a sentence; check may raise InputError"),
]


@pytest.mark.parametrize(("cls", "sentence"), OBJECTIVE_FAULTS, ids=[c.__name__ for c, _ in OBJECTIVE_FAULTS])
def test_a_fault_of_an_objective_is_told(cls: type[AdversarialObjective], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


@dataclass(frozen=True)
class Squares(Reconstruction):
    """Squared differences on the object."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        square = ((preds.normal - target).square() * mask).sum() / mask.sum().clamp(min=1)
        return {"square": Term(square, 1.0)}


class Sum(Squares):
    """Returns the loss itself."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return super().terms(preds, target, mask, where)["square"].value


class Unweighted(Squares):
    """Returns values without weights."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"square": super().terms(preds, target, mask, where)["square"].value}


class Map(Squares):
    """Forgets the mean."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"square": Term((preds.normal - target).square().mean(1), 1.0)}


class Taken(Squares):
    """Takes a name that training logs."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"adversarial": super().terms(preds, target, mask, where)["square"]}


class Negative(Squares):
    """Weighs less than nothing."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"square": Term(super().terms(preds, target, mask, where)["square"].value, -1.0)}


class Cosine(Squares):
    """Wants normals that point away."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"cosine": Term((preds.normal * target).sum(1).mean() + 1, 1.0)}


class Steep(Squares):
    """Has a root whose slope is infinite at 0."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"length": Term((preds.normal - target).square().sum(1).sqrt().mean(), 1.0)}


class MeanOfNothing(Squares):
    """Divides by the number of pixels of the object."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        return {"square": Term(((preds.normal - target).square() * mask).sum() / mask.sum(), 1.0)}


class Overwrites(Squares):
    """Writes into the truth."""

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> Any:
        terms = super().terms(preds, target, mask, where)
        target.mul_(0.5)
        return terms


RECONSTRUCTION_FAULTS = [
    (Sum, "Sum returned Tensor; terms must return the parts of the loss by name"),
    (Unweighted, "Unweighted returned dict of Tensor; terms must return"),
    (Map, "Map (raised|returned) .*term"),
    (Taken, "Taken has a term named adversarial; training logs one itself; rename it"),
    (Negative, "Negative weighs square by -1.0; weights are 0 or more"),
    (Cosine, "Cosine is .* for the truth and .* for .*; the loss is minimised, so it must be less"),
    (Steep, "Steep has a gradient that is infinite or no number at the truth; one infinite value spoils"),
    (MeanOfNothing, "MeanOfNothing is nan for pictures without an object or a hint; it must be finite"),
    (Overwrites, "Overwrites changed the tensors it was given; they belong to the caller"),
]


@pytest.mark.parametrize(
    ("cls", "sentence"), RECONSTRUCTION_FAULTS, ids=[c.__name__ for c, _ in RECONSTRUCTION_FAULTS]
)
def test_a_fault_of_a_reconstruction_is_told(cls: type[Reconstruction], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


def test_those_without_a_fault_pass() -> None:
    check(Plain())
    check(Squares())
