from typing import Any

import pytest
import torch
from torch import Tensor, nn
from torch.nn.utils.parametrizations import spectral_norm

from normalgan.models import Discriminator, Generator, Predictions
from normalgan.testing import ConformanceError, check

torch.set_num_threads(1)


class Predictor(Generator):
    """A convolution, as a generator should be."""

    def __init__(self) -> None:
        super().__init__()
        self.conv = nn.Conv2d(4, 3, 3, padding=1)

    def forward(self, condition: Tensor) -> Any:
        return torch.tanh(self.conv(condition))


class TwoChannels(Predictor):
    """Forgets z."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition)[:, :2]


class Doubles(Predictor):
    """Answers in float64."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition).double()


class Loud(Predictor):
    """Forgets the tanh."""

    def forward(self, condition: Tensor) -> Any:
        return self.conv(condition)


class Unsure(Predictor):
    """Has a confidence that may be below 0."""

    def forward(self, condition: Tensor) -> Any:
        predicted = super().forward(condition)
        return torch.cat([predicted, predicted[:, :1] - 2], dim=1)


class Explodes(Predictor):
    """Divides by what may be nothing."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition) / (condition[:, 3:] * 0)


class Lonely(Predictor):
    """Takes no batch of three."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition).view(min(len(condition), 2), 3, *condition.shape[2:])


class Spare(Predictor):
    """Has a layer that it never asks."""

    def __init__(self) -> None:
        super().__init__()
        self.spare = nn.Linear(1, 1)


class Cut(Predictor):
    """Cuts the gradient off."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition).detach() + 0 * sum(p.sum() for p in self.parameters())


class Blind(Predictor):
    """Paints the same whatever is drawn."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(0 * condition)


class Noisy(Predictor):
    """Draws noise in evaluation too."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition + torch.randn_like(condition))


class Mixes(Predictor):
    """Norms over the batch in evaluation too."""

    def forward(self, condition: Tensor) -> Any:
        return super().forward(condition - condition.mean(0))


class Writes(Predictor):
    """Writes into what it is given."""

    def forward(self, condition: Tensor) -> Any:
        if not condition.requires_grad:
            condition[:, 3] = 0
        return super().forward(condition)


class Forgets(Predictor):
    """Keeps a weight where no checkpoint finds it."""

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("gain", torch.tensor(0.5), persistent=False)

    def forward(self, condition: Tensor) -> Any:
        return torch.tanh(self.conv(condition) * self.gain)


class Counts(Predictor):
    """Scales by a number of Python that training changes, which no checkpoint holds."""

    def __init__(self) -> None:
        super().__init__()
        self.scale = 1.0

    def forward(self, condition: Tensor) -> Any:
        if self.training and torch.is_grad_enabled():
            self.scale *= 0.9
        return torch.tanh(self.conv(condition) * self.scale)


class TrainsAnother(Predictor):
    """Gives the losses something else than it paints."""

    def predict(self, condition: Tensor) -> Any:
        return Predictions(-self(condition).float())


class PlainTuple(Predictor):
    """Predicts a bare tensor."""

    def predict(self, condition: Tensor) -> Any:
        return self(condition)


class Rounds(Predictor):
    """Hands bfloat16 to the losses."""

    def predict(self, condition: Tensor) -> Any:
        return Predictions(self(condition))


class Saturates(Predictor):
    """Is so sure that bfloat16 rounds it to 1, where tanh has no slope."""

    def forward(self, condition: Tensor) -> Any:
        return torch.tanh(self.conv(condition) + 5)


GENERATOR_FAULTS = [
    (TwoChannels, r"TwoChannels returned \(2, 2, 64, 64\) for a condition of .*; it must return normals"),
    (Doubles, "Doubles returned torch.float64 for a condition of torch.float32; it must keep the type"),
    (Loud, r"Loud predicted a component of .*; each component must lie in \[-1, 1\], as by tanh"),
    (Unsure, "Unsure predicted a confidence of 0 or less; the fourth channel must be above 0"),
    (Explodes, "Explodes predicted what is no number; its answer must be finite"),
    (Lonely, "Lonely raised RuntimeError .* when asked for batches of any number; forward must take"),
    (TrainsAnother, "TrainsAnother predicts otherwise than forward returns; what is trained"),
    (PlainTuple, "PlainTuple returned Tensor from predict; it must return Predictions"),
    (Rounds, "Rounds predicts direction in torch.bfloat16 under mixed precision; what losses take"),
    (Saturates, "Saturates has no finite gradient under mixed precision; it must be trainable in bfloat16"),
    (Spare, "Spare gives no gradient to spare.weight, spare.bias; every parameter must take part"),
    (Cut, "Cut has gradients of zero alone; a loss of its answer must reach its parameters"),
    (Blind, "Blind does not look at the condition; its answer must depend on all it is given"),
    (Noisy, "Noisy answers twice the same differently in evaluation; draw random numbers by torch alone"),
    (Mixes, "Mixes answers .* otherwise to a picture in a batch than alone; in evaluation"),
    (Writes, "Writes changed the tensors it was given; they belong to the caller"),
    (Forgets, "Forgets answers otherwise after its state_dict was loaded; keep what it has learnt"),
    (Counts, "Counts answers otherwise after its state_dict was loaded; keep what it has learnt"),
]


@pytest.mark.parametrize(("cls", "sentence"), GENERATOR_FAULTS, ids=[c.__name__ for c, _ in GENERATOR_FAULTS])
def test_a_fault_of_a_generator_is_told(cls: type[Generator], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


class Judge(Discriminator):
    """A convolution of both, as a discriminator should be."""

    def __init__(self) -> None:
        super().__init__()
        self.conv = nn.Conv2d(7, 1, 4, 4)

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return (self.conv(torch.cat([condition, normal], dim=1)),)


class Bare(Judge):
    """Returns a tensor."""

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return super().forward(condition, normal)[0]


class Verdict(Judge):
    """Returns one score for all pictures."""

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return (super().forward(condition, normal)[0].mean()[None],)


class Infinite(Judge):
    """Takes the logarithm of nothing."""

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return ((0 * super().forward(condition, normal)[0]).log(),)


class LooksAway(Judge):
    """Does not look at the map."""

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return super().forward(condition, 0 * normal)


class LooksAtTheMapAlone(Judge):
    """Does not look at the sketch."""

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return super().forward(0 * condition, normal)


DISCRIMINATOR_FAULTS = [
    (Bare, "Bare returned Tensor; it must return a tuple of scores, one tensor a head"),
    (Verdict, r"Verdict returned scores of \(1,\) for 2 pictures; the first axis of each head"),
    (Infinite, "Infinite gave a score that is no number; scores must be finite"),
    (LooksAway, "LooksAway does not look at the normals; its answer must depend"),
    (LooksAtTheMapAlone, "LooksAtTheMapAlone does not look at the condition; its answer must depend"),
]


@pytest.mark.parametrize(
    ("cls", "sentence"), DISCRIMINATOR_FAULTS, ids=[c.__name__ for c, _ in DISCRIMINATOR_FAULTS]
)
def test_a_fault_of_a_discriminator_is_told(cls: type[Discriminator], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


class Spectral(Discriminator):
    """A convolution held Lipschitz by torch's own parametrisation, which cannot be pickled."""

    def __init__(self) -> None:
        super().__init__()
        self.conv = spectral_norm(nn.Conv2d(7, 1, 4, 4))

    def forward(self, condition: Tensor, normal: Tensor) -> Any:
        return (self.conv(torch.cat([condition, normal], dim=1)),)


def test_those_without_a_fault_pass() -> None:
    check(Spectral())
    check(Predictor())
    check(Judge())
