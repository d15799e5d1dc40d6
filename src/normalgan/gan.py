"""NormalGAN: the LightningModule of generator and discriminator, with manual optimisation."""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Annotated, cast

import torch
from lightning.pytorch.callbacks import Callback, GradientAccumulationScheduler, LearningRateFinder
from lightning.pytorch.cli import OptimizerCallable
from lightning.pytorch.core.optimizer import LightningOptimizer
from torch import Tensor, nn
from torch.optim import Optimizer, RMSprop
from torch.optim.lr_scheduler import CosineAnnealingLR, LRScheduler, OneCycleLR, ReduceLROnPlateau

from normalgan.batch import Batch
from normalgan.contracts import check_kinds, describe
from normalgan.errors import InputError, brief, did_you_mean
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
from normalgan.models import Discriminator, Generator
from normalgan.models.base import check_predictions, check_scores
from normalgan.models.compilation import check_compile, compiled_predict
from normalgan.models.condition import make_condition, paste_hints
from normalgan.models.predictions import Predictions
from normalgan.models.statistics import average_statistics
from normalgan.ranges import Count, NonNegative, Positive, PositiveInt, Range, Share, check_ranges
from normalgan.saved_settings import SavedSettings
from normalgan.seeds import derive_seed, seed_torch

ADVERSARIAL_SHARE = "train/adversarial_share"
"""Ratio of the adversarial to the reconstruction gradient norm, at the generator's weights."""

_MONITOR = "val/hints/angular_mean"
"""Metric that a schedule follows if no checkpoint callback names one."""

_INSTEAD: dict[type[Callback], str] = {
    GradientAccumulationScheduler: "use a larger data.batch_size",
    LearningRateFinder: "compare rates with a sweep",
}
"""Callbacks that work only if Lightning steps the optimisers, and what to do instead."""


def _rmsprop(parameters: object) -> Optimizer:
    return RMSprop(cast("list[Tensor]", parameters), lr=5e-5, alpha=0.9)


class NormalGAN(SavedSettings, EvaluationSteps):
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
        pinned: Share = 0.0,
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
        _check_optimizer("generator_optimizer", generator_optimizer)
        _check_optimizer("discriminator_optimizer", discriminator_optimizer)
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
        self._validated: int | None = None  # the last epoch that was validated
        check_ranges(self)

    def setup(self, stage: str) -> None:
        """Make the metrics of a stage, and compile the generator if the settings ask for it."""
        self._generate = None
        self.check_precision()
        if stage == "fit":
            _check_callbacks(getattr(self.trainer, "callbacks", []))
            if self.compile_generator:
                self._generate = compiled_predict(self.generator, self.compile_generator)
            # With max_steps, Lightning mistakes a checkpoint for one saved within an epoch, and ends that
            # epoch a second time; so it has none until `on_train_start`, when the checkpoint has been read:
            # https://github.com/Lightning-AI/pytorch-lightning/blob/2.6.0/src/lightning/pytorch/loops/fit_loop.py
            loop = self.trainer.fit_loop.epoch_loop
            self._max_steps, loop.max_steps = loop.max_steps, -1
        self.make_metrics(stage)
        if stage == "fit":
            _check_monitors(getattr(self.trainer, "callbacks", []), self.val_metrics.names())

    def on_train_start(self) -> None:
        """Restore ``max_steps``, and end a cosine schedule with the run, also if it is resumed for longer.

        Raises:
            InputError: if a one-cycle schedule has another length than the run.
        """
        self.trainer.fit_loop.epoch_loop.max_steps = self._max_steps
        epochs = self.trainer.max_epochs
        for config in self.trainer.lr_scheduler_configs:
            if isinstance(config.scheduler, CosineAnnealingLR) and epochs is not None and epochs > 0:
                _end_cosine_at(config.scheduler, epochs)
            if isinstance(config.scheduler, OneCycleLR) and epochs is not None and epochs > 0:
                _check_one_cycle(config.scheduler, epochs)

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

    def on_before_optimizer_step(self, optimizer: Optimizer) -> None:
        """Clip the generator's gradient, after mixed precision has unscaled it."""
        if self.gradient_clip is not None and optimizer is self.trainer.optimizers[0]:
            nn.utils.clip_grad_norm_(self.generator.parameters(), self.gradient_clip)

    def on_validation_start(self) -> None:
        """Average batch norm's statistics over all processes, so that they validate the same network."""
        self._average_statistics()

    def _average_statistics(self) -> None:
        if self.trainer.world_size > 1:
            average_statistics(self, partial(self.trainer.strategy.reduce, reduce_op="mean"))

    def on_train_epoch_end(self) -> None:
        """Step the learning rate schedules, which Lightning does not do in manual optimisation."""
        self._average_statistics()  # for the checkpoint of an epoch without validation
        if not self.trainer.fit_loop.epoch_loop.batch_progress.is_last_batch:
            return  # max_steps or max_time stopped the run within the epoch; the rates change at its end
        schedulers = self.lr_schedulers()
        for scheduler in schedulers if isinstance(schedulers, list) else [schedulers]:
            if isinstance(scheduler, ReduceLROnPlateau):
                if self._validated == self.current_epoch:
                    scheduler.step(self._monitored())
            elif scheduler is not None:
                scheduler.step()

    def on_validation_end(self) -> None:
        """Note the epoch, whose error a schedule may follow."""
        if not self.trainer.sanity_checking:
            self._validated = self.current_epoch

    def _monitored(self) -> Tensor:
        """Return the metric by which the best checkpoint is chosen, of the last validation."""
        monitors = [getattr(each, "monitor", None) for each in self.trainer.checkpoint_callbacks]
        name = next((each for each in monitors if each), _MONITOR)
        if name not in self.trainer.callback_metrics:
            raise InputError(
                f"ReduceLROnPlateau follows the monitor of checkpoints, {name}, which was not logged."
            )
        return self.trainer.callback_metrics[name]

    def configure_optimizers(self) -> tuple[list[Optimizer], list[LRScheduler]]:
        """Return the optimisers of the generator and of the discriminator, in this order."""
        optimizers = [_optimizer(self.generator_optimizer, self.generator, "generator_optimizer")]
        if self.discriminator is not None:
            name = "discriminator_optimizer"
            optimizers.append(_optimizer(self.discriminator_optimizer, self.discriminator, name))
        try:
            return optimizers, [self.lr_scheduler(o) for o in optimizers] if self.lr_scheduler else []
        except ValueError as error:  # such as a negative factor, which is found only here
            raise InputError(f"lr_scheduler cannot be used: {brief(error)}.") from error

    def _optimizers(self) -> list[LightningOptimizer]:
        optimizers = self.optimizers()
        return cast(list[LightningOptimizer], optimizers if isinstance(optimizers, list) else [optimizers])


def _check_optimizer(name: str, optimizer: object) -> None:
    if not callable(optimizer):
        raise InputError(
            f"{name} must make an optimiser of parameters, such as partial(torch.optim.Adam, lr=1e-4), "
            f"not be {describe(optimizer)}."
        )


def _check_callbacks(callbacks: Iterable[object]) -> None:
    """Refuse callbacks that work only if Lightning steps the optimisers.

    Raises:
        InputError: if there is such a callback.
    """
    for callback in callbacks:
        for kind, instead in _INSTEAD.items():
            if isinstance(callback, kind):
                raise InputError(
                    f"{kind.__name__} cannot be used, because NormalGAN steps its optimisers by hand; "
                    f"{instead}."
                )


def _check_monitors(callbacks: Iterable[object], known: Sequence[str]) -> None:
    """Check that the metrics by which callbacks stop or save are those that validation logs.

    Names outside the rows of validation are not checked, because callbacks may log metrics of their own.

    Raises:
        InputError: if a name is unknown; otherwise Lightning finds it only after the first epoch.
    """
    rows = tuple(dict.fromkeys(name.rpartition("/")[0] + "/" for name in known))
    figures = dict.fromkeys(name.rpartition("/")[2] for name in known)
    for callback in callbacks:
        name = getattr(callback, "monitor", None)
        if isinstance(name, str) and name.startswith(rows) and name not in known:
            raise InputError(
                f"{type(callback).__name__} monitors {name}, which validation does not log."
                f"{did_you_mean(name, known)} It logs, after {' and '.join(rows)}, {', '.join(figures)}."
            )


def _optimizer(make: OptimizerCallable, network: nn.Module, name: str) -> Optimizer:
    try:
        return make(network.parameters())
    except ValueError as error:  # such as a negative learning rate, which is found only here
        raise InputError(f"{name} cannot be used: {brief(error)}.") from error


def _check_one_cycle(schedule: OneCycleLR, epochs: int) -> None:
    """Check that a one-cycle schedule ends with the run; a longer run would fail, a shorter one end too high.

    Raises:
        InputError: if its length is not the number of epochs.
    """
    if schedule.total_steps != epochs:
        raise InputError(
            f"OneCycleLR has {schedule.total_steps} steps, one for each epoch, but the run has {epochs} "
            f"epochs; set total_steps of model.lr_scheduler to {epochs}. A resumed run keeps its schedule: "
            "start another run from its weights, by the callback StartFrom."
        )


def _end_cosine_at(schedule: CosineAnnealingLR, epochs: int) -> None:
    """Change the length of a cosine schedule, and update the learning rate of the current epoch.

    PyTorch derives each rate from the previous one, so a schedule that has reached 0 would stay there.

    Args:
        schedule: schedule that is stepped once per epoch; unchanged if it already has this length.
        epochs: number of epochs until the lowest rate.
    """
    if schedule.T_max == epochs:
        return
    schedule.T_max = epochs
    share = (1 + math.cos(math.pi * schedule.last_epoch / epochs)) / 2
    for group, rate in zip(schedule.optimizer.param_groups, schedule.base_lrs, strict=True):
        group["lr"] = schedule.eta_min + (rate - schedule.eta_min) * share


def _weighted(terms: dict[str, Term]) -> Tensor:
    return torch.stack([term.weight * term.value for term in terms.values()]).sum()
