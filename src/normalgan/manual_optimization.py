"""ManualOptimization: the optimisers and learning-rate schedules of a run, which it steps by hand."""

import math
from collections.abc import Callable, Iterable
from typing import cast

from lightning.pytorch import LightningModule
from lightning.pytorch.callbacks import (
    Callback,
    GradientAccumulationScheduler,
    LearningRateFinder,
    StochasticWeightAveraging,
)
from lightning.pytorch.cli import OptimizerCallable
from lightning.pytorch.core.optimizer import LightningOptimizer
from torch import Tensor, nn
from torch.optim import Optimizer
from torch.optim.lr_scheduler import CosineAnnealingLR, LRScheduler, OneCycleLR, ReduceLROnPlateau

from normalgan.contracts import describe
from normalgan.errors import InputError, brief
from normalgan.models import Discriminator, Generator

_MONITOR = "val/hints/angular_mean"
"""Metric that a schedule follows if no checkpoint callback names one."""

_INSTEAD: dict[type[Callback], str] = {
    GradientAccumulationScheduler: "use a larger data.batch_size",
    LearningRateFinder: "compare rates with a sweep",
    # Its last epoch measures the statistics of batch norm, and would train the averaged weights.
    StochasticWeightAveraging: "use WarmAverage",
}
"""Callbacks that work only if Lightning steps the optimisers, and what to do instead."""


class ManualOptimization(LightningModule):
    """LightningModule with an optimiser for each of two networks, and one schedule for both.

    Attributes:
        generator: network that the first optimiser trains.
        discriminator: network that the second optimiser trains, or None.
        generator_optimizer: makes the first optimiser.
        discriminator_optimizer: makes the second optimiser.
        lr_scheduler: makes the schedule of an optimiser, stepped after each epoch; None keeps the rates.
        gradient_clip: largest norm of the generator's gradient; None leaves it as it is.
    """

    generator: Generator
    discriminator: Discriminator | None
    generator_optimizer: OptimizerCallable
    discriminator_optimizer: OptimizerCallable
    lr_scheduler: Callable[[Optimizer], LRScheduler] | None
    gradient_clip: float | None
    _validated: int | None = None
    """The last epoch that was validated."""

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

    def setup(self, stage: str) -> None:
        """Check the callbacks of a training run.

        Raises:
            InputError: if a callback works only if Lightning steps the optimisers.
        """
        if stage == "fit":
            _check_callbacks(getattr(self.trainer, "callbacks", []))
            # With max_steps, Lightning mistakes a checkpoint for one saved within an epoch, and ends that
            # epoch a second time; so it has none until `on_train_start`, when the checkpoint has been read:
            # https://github.com/Lightning-AI/pytorch-lightning/blob/2.6.0/src/lightning/pytorch/loops/fit_loop.py
            loop = self.trainer.fit_loop.epoch_loop
            self._max_steps, loop.max_steps = loop.max_steps, -1

    def on_train_start(self) -> None:
        """Restore ``max_steps``, and end a cosine schedule with the run, also if it is resumed for longer.

        Raises:
            InputError: if a one-cycle schedule has another length than the run, or a plateau is sought in the
                wrong direction.
        """
        self.trainer.fit_loop.epoch_loop.max_steps = self._max_steps
        epochs = self.trainer.max_epochs
        for config in self.trainer.lr_scheduler_configs:
            if isinstance(config.scheduler, CosineAnnealingLR) and epochs is not None and epochs > 0:
                _end_cosine_at(config.scheduler, epochs)
            if isinstance(config.scheduler, OneCycleLR) and epochs is not None and epochs > 0:
                _check_one_cycle(config.scheduler, epochs)
            if isinstance(config.scheduler, ReduceLROnPlateau):
                _check_plateau(config.scheduler, self.trainer.checkpoint_callbacks)

    def on_before_optimizer_step(self, optimizer: Optimizer) -> None:
        """Clip the generator's gradient, after mixed precision has unscaled it."""
        if self.gradient_clip is not None and optimizer is self.trainer.optimizers[0]:
            nn.utils.clip_grad_norm_(self.generator.parameters(), self.gradient_clip)

    def on_validation_end(self) -> None:
        """Note the epoch, whose error a schedule may follow."""
        if not self.trainer.sanity_checking:
            self._validated = self.current_epoch

    def on_train_epoch_end(self) -> None:
        """Step the learning rate schedules, which Lightning does not do in manual optimisation."""
        if not self.trainer.fit_loop.epoch_loop.batch_progress.is_last_batch:
            return  # max_steps or max_time stopped the run within the epoch; the rates change at its end
        schedulers = self.lr_schedulers()
        for scheduler in schedulers if isinstance(schedulers, list) else [schedulers]:
            if isinstance(scheduler, ReduceLROnPlateau):
                if self._validated == self.current_epoch:
                    scheduler.step(self._monitored())
            elif scheduler is not None:
                scheduler.step()

    def _monitored(self) -> Tensor:
        """Return the metric by which the best checkpoint is chosen, of the last validation."""
        monitors = [getattr(each, "monitor", None) for each in self.trainer.checkpoint_callbacks]
        name = next((each for each in monitors if each), _MONITOR)
        if name not in self.trainer.callback_metrics:
            raise InputError(
                f"ReduceLROnPlateau follows the monitor of checkpoints, {name}, which was not logged."
            )
        return self.trainer.callback_metrics[name]


def check_optimizer(name: str, optimizer: object) -> None:
    """Check that an argument makes an optimiser.

    Raises:
        InputError: if it does not.
    """
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


def _check_plateau(schedule: ReduceLROnPlateau, checkpoints: Iterable[object]) -> None:
    """Check that a schedule takes the same direction for better as the checkpoints whose monitor it follows.

    Raises:
        InputError: if it does not, because it would lower the rate while the run improves.
    """
    followed = next((each for each in checkpoints if getattr(each, "monitor", None)), None)
    mode = getattr(followed, "mode", "min")
    if schedule.mode != mode:
        raise InputError(
            f"ReduceLROnPlateau has the mode {schedule.mode}, but the monitor of checkpoints, which it "
            f"follows, has {mode}; set mode of model.lr_scheduler to {mode}."
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
