"""NormalGAN: the LightningModule of generator and discriminator, with manual optimisation."""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Annotated, cast

import torch
from lightning.pytorch.cli import OptimizerCallable
from torch import Tensor
from torch.optim import Optimizer, RMSprop
from torch.optim.lr_scheduler import LRScheduler

from normalgan.batch import Batch
from normalgan.contracts import check_kinds
from normalgan.evaluation import EvaluationSteps
from normalgan.hints import HintSampler
from normalgan.hints.draw import draw_hints
from normalgan.hints.noise import perturb_hints
from normalgan.hints.pins_in_turn import pin_in_turn
from normalgan.line_widths import USUAL_WIDTHS, LineWidths, check_line_widths
from normalgan.losses import AdversarialObjective, L1AndHints, Reconstruction, Term
from normalgan.losses.checks import check_losses, check_terms
from normalgan.losses.distractor_consistency import distractor_inconsistency, with_distractor_strokes
from normalgan.losses.finite import start_finite_check
from normalgan.losses.gradient_share import gradient_share
from normalgan.manual_optimization import ManualOptimization, check_optimizer
from normalgan.models import Discriminator, Generator
from normalgan.models.base import check_predictions, check_scores
from normalgan.models.compilation import check_compile, compiled_predict
from normalgan.models.condition import make_condition, paste_hints
from normalgan.models.predictions import Predictions
from normalgan.models.statistics import average_statistics
from normalgan.ranges import Count, NonNegative, Positive, PositiveInt, Range, UnitInterval, check_ranges
from normalgan.saved_settings import SavedSettings
from normalgan.seeds import derive_seed, seed_torch

ADVERSARIAL_SHARE = "train/adversarial_share"
"""Ratio of the adversarial to the reconstruction gradient norm, at the generator's weights."""


def _rmsprop(parameters: object) -> Optimizer:
    return RMSprop(cast("list[Tensor]", parameters), lr=5e-5, alpha=0.9)


class NormalGAN(SavedSettings, EvaluationSteps, ManualOptimization):
    """Predicts a normal map from a sketch and hints, and trains against a discriminator.

    Each training step seeds all of its randomness (dropout, hints, gradient penalty) with its own number, so
    a run that is killed and resumed ends with the same weights as an uninterrupted one.

    Args:
        generator: the network that predicts normal maps.
        discriminator: the network that distinguishes predicted maps from true ones; None trains on the
            reconstruction loss alone.
        hint_sampler: chooses the hints in training and testing, in place of a designer. A batch that has
            hints keeps them. Prediction uses only the hints that are given.
        objective: the adversarial losses.
        generator_optimizer: optimiser of the generator.
        discriminator_optimizer: optimiser of the discriminator.
        lr_scheduler: schedule of both learning rates, stepped after each epoch; None keeps them constant.
            ``CosineAnnealingLR`` ends at ``max_epochs``, whatever its ``T_max``. ``ReduceLROnPlateau``
            follows the metric that ``checkpoint.monitor`` names.
        adversarial_weight: weight of the objective's generator loss.
        reconstruction: the per-pixel loss.
        gradient_clip: largest norm of the generator's gradient; None leaves it as it is.
        n_critic: discriminator steps per generator step, with one batch each.
        pinned: fraction of each batch that gets up to three more hints (pins), one at a time, each where the
            prediction with the hints so far is worst. Each pin costs one more forward pass of these samples.
        hint_noise: largest mean angle in degrees by which the hints of a training sample are rotated.
        distractor_consistency: weight of the mean angle in radians between the normals predicted with and
            without distractor strokes. A quarter of each batch is predicted twice for it. 0 switches it off.
        share_every: log the ratio of the adversarial to the reconstruction gradient norm every this many
            generator steps, at the generator's weights (``train/adversarial_share``) and at the predicted
            directions (``train/adversarial_share_output``). Such a step takes two more backward passes; 0
            logs none.
        noise_at_test: keep the noise z (dropout of any kind) on when testing and predicting, as pix2pix does.
        seed: seed of the hints and of the noise.
        refined: whether the package's refiner sharpens its maps when they are enlarged to a drawing's size.
            The refiner was trained for the shipped weights.
        line_widths: thinnest and thickest line, in pixels of the model's input, that prediction leaves as
            drawn. Thinner and thicker lines are redrawn 1.25 pixels wide. Set it to the widths in training.
        compile: whether to compile the generator's forward pass in training with ``torch.compile``; a string
            selects another backend than the default, which needs a C++ compiler. Checkpoints do not hold it.

    References:
        He et al. 2021, "Sketch-based Normal Map Generation with Geometric Sampling".
    """

    def __init__(
        self,
        generator: Generator,
        discriminator: Discriminator | None,
        hint_sampler: HintSampler,
        objective: AdversarialObjective,
        generator_optimizer: OptimizerCallable = _rmsprop,
        discriminator_optimizer: OptimizerCallable = _rmsprop,
        lr_scheduler: Callable[[Optimizer], LRScheduler] | None = None,
        adversarial_weight: NonNegative = 1.0,
        reconstruction: Reconstruction = L1AndHints(),  # noqa: B008  # frozen
        gradient_clip: Positive | None = None,
        n_critic: PositiveInt = 5,
        pinned: UnitInterval = 0.0,
        hint_noise: Annotated[float, Range(0, 90)] = 0.0,
        distractor_consistency: NonNegative = 0.0,
        share_every: Count = 0,
        noise_at_test: bool = False,
        seed: int = 0,
        refined: bool = False,
        line_widths: LineWidths = USUAL_WIDTHS,
        compile: bool | str = False,
    ) -> None:
        super().__init__()
        kinds: dict[str, tuple[object, type]] = {
            "generator": (generator, Generator),
            "discriminator": (discriminator, Discriminator),
            "hint_sampler": (hint_sampler, HintSampler),
            "objective": (objective, AdversarialObjective),
            "reconstruction": (reconstruction, Reconstruction),
        }
        check_kinds(kinds, optional=["discriminator"])
        check_optimizer("generator_optimizer", generator_optimizer)
        check_optimizer("discriminator_optimizer", discriminator_optimizer)
        if discriminator is not None:
            objective.check(discriminator)
        with warnings.catch_warnings():
            # From the command line the settings are saved; in Python the objects themselves, on purpose.
            warnings.filterwarnings("ignore", message=".*is an instance of `nn.Module`.*")
            self.save_hyperparameters()
        self.automatic_optimization = False
        self.generator = generator
        self.discriminator = discriminator
        self.hint_sampler = hint_sampler
        self.objective = objective
        self.generator_optimizer = generator_optimizer
        self.discriminator_optimizer = discriminator_optimizer
        self.lr_scheduler = lr_scheduler
        self.adversarial_weight = adversarial_weight
        self.reconstruction = reconstruction
        self.gradient_clip = gradient_clip
        self.n_critic = n_critic
        self.pinned = pinned
        self.hint_noise = hint_noise
        self.distractor_consistency = distractor_consistency
        self.share_every = share_every
        self.noise_at_test = noise_at_test
        self.seed = seed
        self.refined = refined
        self.line_widths = check_line_widths(line_widths)
        self.compile_generator = check_compile(compile)
        self._generate: Callable[[Tensor], Predictions] | None = None  # compiled, while a run trains
        check_ranges(self)

    def setup(self, stage: str) -> None:
        """Make the metrics of a stage, and compile the generator if the settings ask for it."""
        self._generate = None
        self.check_precision()
        super().setup(stage)
        if stage == "fit" and self.compile_generator:
            self._generate = compiled_predict(self.generator, self.compile_generator)
        self.make_metrics(stage)

    def teardown(self, stage: str) -> None:
        """Drop the compiled function, which cannot be copied or pickled."""
        self._generate = None

    # torch.compile(model) would also compile Lightning's code between the networks, which it cannot trace.
    @torch.compiler.disable  # type: ignore[untyped-decorator]
    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Step the discriminator, and the generator with every ``n_critic``-th batch."""
        step = self.trainer.fit_loop.total_batch_idx  # counts across epochs; batch_idx does not
        seed = derive_seed("train", self.seed, step, self.global_rank)
        seed_torch(seed, self.device)
        self._picture_size = int(batch["sketch"].shape[-1])  # which `SavedSettings` saves
        hints = self.training_hints(batch, seed)
        if self.hint_noise:
            hints = perturb_hints(hints, self.hint_noise, derive_seed("hint noise", seed))
        condition = make_condition(batch["sketch"], hints)
        trains_generator = self.discriminator is None or step % self.n_critic == 0  # step 0 trains both
        distracted: Tensor | None = None
        if trains_generator and self.distractor_consistency > 0:
            # The first sketches of the batch again, with strokes that should not change their maps.
            distracted = with_distractor_strokes(batch["sketch"], batch["mask"])
        with torch.set_grad_enabled(trains_generator):
            preds, distracted_direction = self._predict_both(condition, distracted, hints)
        fake: Tensor | None = None  # the predicted maps as a discriminator sees them
        if self.discriminator is not None:
            fake = paste_hints(preds.normal, hints).to(condition.dtype)
            self._step_discriminator(self.discriminator, condition, batch, fake.detach())
        if trains_generator:
            terms = self.reconstruction.terms(
                preds, batch["normal"].float(), batch["mask"].float(), hints[:, 3:].float()
            )
            check_terms(self.reconstruction, terms, alone=self.discriminator is None)
            if distracted_direction is not None:
                angle = distractor_inconsistency(preds.direction, distracted_direction, batch["mask"].float())
                terms = {**terms, "distractor_inconsistency": Term(angle, self.distractor_consistency)}
            self._step_generator(condition, terms, preds.direction, fake, batch)

    def _predict_both(
        self, condition: Tensor, distracted: Tensor | None, hints: Tensor
    ) -> tuple[Predictions, Tensor | None]:
        """Return predictions for a batch, and directions for its first sketches with distractor strokes."""
        if distracted is None:
            return self._predict_training(condition), None
        # In one pass, so that batch norm has the same statistics for both.
        both = torch.cat([condition, make_condition(distracted, hints[: len(distracted)])])
        preds, count = self._predict_training(both), len(condition)
        return preds.of(slice(count)), preds.direction[count:]

    def _predict_training(self, condition: Tensor) -> Predictions:
        preds = (self._generate or self.generator.predict)(condition)
        check_predictions(self.generator, preds, condition)
        return preds

    def training_hints(self, batch: Batch, seed: int) -> Tensor:
        """Return a batch's hints (N, 4, H, W): its own, or else the sampler's and the pins."""
        if "hints" in batch:
            return batch["hints"]
        hints = draw_hints(self.hint_sampler, batch["normal"], batch["mask"], seed, self._error(batch))
        # The last samples of the batch get pins, because the first ones get distractor strokes.
        start = len(hints) - round(self.pinned * len(hints))
        if start == len(hints):
            return hints
        last = slice(start, None)
        with self._eval_mode():
            pinned = pin_in_turn(
                lambda given: self(batch["sketch"][last], given).float(),
                batch["normal"][last],
                batch["mask"][last],
                hints[last],
                derive_seed("pins", seed),
            )
        return torch.cat([hints[:start], pinned])

    def _step_discriminator(
        self, discriminator: Discriminator, condition: Tensor, batch: Batch, fake: Tensor
    ) -> None:
        optimizer, real = self._optimizers()[1], batch["normal"]
        with self.toggled_optimizer(optimizer):
            # Two passes: in one, batch norm would mix the statistics of true and predicted maps.
            loss = self.objective.discriminator_loss(
                check_scores(discriminator, discriminator(condition, real), condition),
                check_scores(discriminator, discriminator(condition, fake), condition),
            )
            penalty = self.objective.penalty(lambda normal: discriminator(condition, normal), real, fake)
            check_losses(self.objective, {"discriminator_loss": loss, "penalty": penalty})
            check_finite = start_finite_check(
                {"discriminator": loss, "penalty": penalty}, self.trainer.world_size
            )
            optimizer.zero_grad()
            self.manual_backward(loss + penalty)
            values = check_finite(batch, *self._epoch_and_batch())
            optimizer.step()
            self.objective.after_discriminator_step(discriminator)
        if self._logs_losses(1):
            self.log("train/discriminator", values["discriminator"], prog_bar=True)

    def _step_generator(
        self, condition: Tensor, terms: dict[str, Term], direction: Tensor, fake: Tensor | None, batch: Batch
    ) -> None:
        optimizer = self._optimizers()[0]
        with self.toggled_optimizer(optimizer):  # else its loss would leave gradients on the critic
            if self.discriminator is not None and fake is not None:
                scores = check_scores(self.discriminator, self.discriminator(condition, fake), condition)
                score = self.objective.generator_loss(scores)
                check_losses(self.objective, {"generator_loss": score})
                adversarial = Term(score, self.adversarial_weight)
                if self._logs_share():
                    self._log_share(_weighted(terms), adversarial.weight * adversarial.value, direction)
                terms = {**terms, "adversarial": adversarial}
            losses = {name: term.value for name, term in terms.items()}
            check_finite = start_finite_check(losses, self.trainer.world_size)
            optimizer.zero_grad()
            self.manual_backward(_weighted(terms))
            values = check_finite(batch, *self._epoch_and_batch())
            optimizer.step()
        if self._logs_losses(1 if self.discriminator is None else self.n_critic):
            self.log_dict({f"train/{name}": value for name, value in values.items()})
            first = next(iter(values))
            self.log(first, values[first], prog_bar=True, logger=False)  # the bar shows it without "train/"

    def _epoch_and_batch(self) -> tuple[int, int]:
        """Return the epoch and the index of the batch in it, for error messages."""
        return self.current_epoch, self.trainer.fit_loop.epoch_loop.batch_idx

    def _logs_losses(self, every: int) -> bool:
        """Return whether to log the losses of this batch, of a network that steps every ``every`` batches.

        Logging costs a few per cent of a step, and loggers keep only one step in ``log_every_n_steps``.
        """
        interval: int = self.trainer.log_every_n_steps  # type: ignore[attr-defined]  # documented, not typed
        to_come = interval - 1 - self.trainer.fit_loop.total_batch_idx % max(interval, 1)
        first = self.trainer.fit_loop.epoch_loop.batch_idx < every  # for the progress bar
        return first or 0 <= to_come < every  # the last step in the interval

    def _logs_share(self) -> bool:
        step = self.trainer.fit_loop.total_batch_idx // self.n_critic
        return self.share_every > 0 and step % self.share_every == 0

    def _log_share(self, reconstruction: Tensor, adversarial: Tensor, direction: Tensor) -> None:
        self.log(
            ADVERSARIAL_SHARE, gradient_share(adversarial, reconstruction, list(self.generator.parameters()))
        )
        self.log(f"{ADVERSARIAL_SHARE}_output", gradient_share(adversarial, reconstruction, [direction]))

    def on_validation_start(self) -> None:
        """Average batch norm's statistics over all processes, so that they validate the same network."""
        self._average_statistics()

    def on_train_epoch_end(self) -> None:
        """Average the statistics for the checkpoint of an epoch without validation; step the schedules."""
        self._average_statistics()
        super().on_train_epoch_end()

    def _average_statistics(self) -> None:
        if self.trainer.world_size > 1:
            average_statistics(self, partial(self.trainer.strategy.reduce, reduce_op="mean"))


def _weighted(terms: dict[str, Term]) -> Tensor:
    return torch.stack([term.weight * term.value for term in terms.values()]).sum()
