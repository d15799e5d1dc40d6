"""What somebody else's classes give in training: a wrong thing is one sentence that names the class."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from torch import Tensor, nn

from normalgan.errors import InputError
from normalgan.hints import HintSampler
from normalgan.losses import Reconstruction, Term, Wasserstein
from normalgan.models import Discriminator, Generator
from normalgan.models.predictions import Predictions
from small import QUIET, gan, trainer
from spheres import loader

pytestmark = [pytest.mark.filterwarnings(each) for each in QUIET] + [
    pytest.mark.filterwarnings("ignore:.*have no `val_dataloader`.*"),
    pytest.mark.filterwarnings("ignore:.*removed from hparams because it cannot be pickled.*"),
]


class Sampler(HintSampler):
    """Gives whatever it is told to."""

    def __init__(self, give: Callable[[Tensor], Any]) -> None:
        self.give = give

    def sample(self, normal: Tensor, mask: Tensor, rng: torch.Generator) -> Tensor:
        where: Tensor = self.give(mask)
        return where


class Predictor(Generator):
    """Changes what a convolution paints."""

    def __init__(self, give: Callable[[Tensor], Any], channels: int = 3) -> None:
        super().__init__()
        self.convolution = nn.Conv2d(4, channels, 1)
        self.give = give

    def forward(self, condition: Tensor) -> Tensor:
        predicted: Tensor = self.give(self.convolution(condition))
        return predicted


class Teller(Predictor):
    """Tells the losses something of its own."""

    def predict(self, condition: Tensor) -> Predictions:
        preds: Predictions = self.give(self.convolution(condition))
        return preds


class Critic(Discriminator):
    """Changes the scores of a convolution."""

    def __init__(self, give: Callable[[Tensor], Any]) -> None:
        super().__init__()
        self.convolution = nn.Conv2d(7, 1, 1)
        self.give = give

    def forward(self, condition: Tensor, normal: Tensor) -> tuple[Tensor, ...]:
        scores: tuple[Tensor, ...] = self.give(self.convolution(torch.cat([condition, normal], dim=1)))
        return scores


class Loss(Reconstruction):
    """Makes what it is told to of the difference to the truth."""

    def __init__(self, give: Callable[[Tensor], Any]) -> None:
        self.give = give

    def terms(self, preds: Predictions, target: Tensor, mask: Tensor, where: Tensor) -> dict[str, Term]:
        terms: dict[str, Term] = self.give((preds.normal - target).abs())
        return terms


class PixelObjective(Wasserstein):
    """Forgets to take the mean."""

    def generator_loss(self, fake: tuple[Tensor, ...]) -> Tensor:
        return -fake[0]


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "hints without a channel": (
        {"hint_sampler": Sampler(lambda mask: mask[:, 0])},
        r"^Sampler gave a tensor \(2, 32, 32\); hints are a tensor \(2, 1, 32, 32\) here, 1 at a hinted pi",
    ),
    "no hints returned": (
        {"hint_sampler": Sampler(lambda mask: None)},
        r"^Sampler gave None; hints are a ten",
    ),
    "maps of two channels": (
        {"generator": Predictor(lambda predicted: predicted, 2)},
        r"^Predictor returns 2 channels; a model has 3, or 4 with the confidence\.$",
    ),
    "smaller maps": (
        {"generator": Predictor(lambda predicted: predicted[..., 1:-1, ::2])},
        r"^Predictor returns 16 × 30 pixels for a sketch of 32 × 32; a map is as large as its sketch\.$",
    ),
    "several maps": (
        {"generator": Predictor(lambda predicted: (predicted, predicted))},
        r"^Predictor gave a tuple of \(a tensor \(2, 3, 32, 32\), a tensor \(2, 3, 32, 32\)\); a generator g",
    ),
    "maps that teach nothing": (
        {"generator": Predictor(lambda predicted: predicted.detach())},
        r"^Predictor returns maps without a gradient; do not detach them",
    ),
    "predictions that are maps": (
        {"generator": Teller(lambda predicted: predicted)},
        r"^Teller\.predict gave a tensor \(2, 3, 32, 32\); "
        r"it gives normalgan\.models\.predictions\.Predictions\.$",
    ),
    "a confidence of no size": (
        {"generator": Teller(lambda predicted: Predictions(predicted, confidence=predicted[:, 0]))},
        r"^Teller\.predict gave a tensor \(2, 32, 32\) as confidence; it is a tensor \(2, 1, 32, 32\) here",
    ),
    "scores in no tuple": (
        {"discriminator": Critic(lambda scores: scores)},
        r"^Critic gave a tensor \(2, 1, 32, 32\); a discriminator gives a tuple of scores, a tensor \(2, …",
    ),
    "no scores": (
        {"discriminator": Critic(lambda scores: ())},
        r"^Critic gave an empty tuple; a discriminator gives a tuple of scores",
    ),
    "a map of losses": (
        {"reconstruction": Loss(lambda difference: {"l1": Term(difference, 1)})},
        r"^Loss gave a tensor \(2, 3, 32, 32\) as l1; a reconstruction loss gives its terms by name, a Ter",
    ),
    "a loss that teaches nothing": (
        {"reconstruction": Loss(lambda difference: {"l1": Term(difference.mean().detach(), 1)})},
        r"^Loss gave terms without a gradient; do not detach the map\.$",
    ),
    "no loss at all": (
        {"reconstruction": Loss(lambda difference: {}), "discriminator": None},
        r"^Loss gave an empty dict; a reconstruction loss gives its terms by name",
    ),
    "an objective a pixel": (
        {"objective": PixelObjective()},
        r"^PixelObjective\.generator_loss gave a tensor \(2, .*\); it gives a tensor of one number\.$",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_a_plug_in_gives_wrongly_is_told_by_its_name(wrong: str, tmp_path: Path) -> None:
    settings, sentence = WRONG[wrong]
    with pytest.raises(InputError, match=sentence):
        trainer(tmp_path).fit(gan(**settings), loader(2))


@pytest.mark.parametrize(
    ("sampler", "sentence"),
    [
        (
            Sampler(lambda mask: mask * torch.nan),
            r"^Sampler gave hints with the value nan; hints are a tensor \(1, 1, 32, 32\) here, 1 at",
        ),
        (Sampler(lambda mask: mask * 0.25), r"^Sampler gave hints with the value 0\.25; hints"),
        (Sampler(torch.ones_like), r"^Sampler gave \d+ hints off the object; hints must lie where mask is 1"),
    ],
    ids=["no numbers", "weights", "off the object"],
)
def test_values_of_hints_are_looked_at_in_validation(
    sampler: HintSampler, sentence: str, tmp_path: Path
) -> None:
    """Training does not: it would wait for the device."""
    with pytest.raises(InputError, match=sentence):
        trainer(tmp_path).validate(gan(hint_sampler=sampler), loader(2), verbose=False)


def test_a_critic_alone_may_teach(tmp_path: Path) -> None:
    taught = gan(reconstruction=Loss(lambda difference: {}), hint_sampler=Sampler(lambda mask: mask > 0))
    trainer(tmp_path).fit(taught, loader(2))
    assert taught.trainer.global_step == 2


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (
            {"generator": nn.Conv2d(4, 3, 1)},
            r"^generator must be an object of a class of Generator, not a Conv2d\.$",
        ),
        ({"discriminator": "PatchDiscriminator"}, r"^discriminator must be .* not 'PatchDiscriminator'\.$"),
        ({"hint_sampler": Sampler}, r"^hint_sampler must be .* not the class Sampler; write Sampler\(…\)\.$"),
        (
            {"objective": None},
            r"^objective must be an object of a class of AdversarialObjective, not None\.$",
        ),
        ({"reconstruction": nn.L1Loss()}, r"^reconstruction must be .* of Reconstruction, not a L1Loss\.$"),
        (
            {"generator_optimizer": torch.optim.Adam([nn.Parameter(torch.zeros(1))])},
            r"^generator_optimizer must make an optimiser of parameters, such as partial.*, not be an Adam",
        ),
    ],
)
def test_a_part_that_is_none_is_told_when_the_model_is_made(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        gan(**given)
