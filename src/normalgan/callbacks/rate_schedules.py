"""Learning-rate schedules as callbacks: over a time budget, or constant with a cool-down."""

import math
from abc import ABC, abstractmethod
from time import monotonic
from typing import Annotated, Any

from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch
from normalgan.errors import InputError
from normalgan.ranges import Count, Positive, PositiveInt, Range, check_ranges


class _RateSchedule(Callback, ABC):
    """Multiplies all learning rates of a run by a factor, which is updated before each batch."""

    def __init__(self) -> None:
        self._rates: list[list[float]] = []  # unscaled, by optimiser and parameter group

    @abstractmethod
    def _factor(self, trainer: Trainer) -> float:
        """Return the factor of the next batch."""

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Record the learning rates of the optimisers.

        Raises:
            InputError: if there is another learning-rate schedule.
        """
        if trainer.lr_scheduler_configs:
            raise InputError(
                f"{type(self).__name__} sets the learning rates itself; set model.lr_scheduler to null."
            )
        if not self._rates:  # optimisers restored from a checkpoint hold rates that are already scaled
            self._rates = [[group["lr"] for group in each.param_groups] for each in trainer.optimizers]

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        """Set the learning rates."""
        factor = self._factor(trainer)
        for optimizer, rates in zip(trainer.optimizers, self._rates, strict=True):
            for group, rate in zip(optimizer.param_groups, rates, strict=True):
                group["lr"] = factor * rate


def cosine_factor(progress: float, warmup: float) -> float:
    """Return the factor of a learning rate: a linear warm-up, then half a cosine down to 0.

    Args:
        progress: fraction of the budget that is spent, 0 or more; beyond 1, the factor is 0.
        warmup: fraction of the budget for the warm-up, at least 0 and below 1.

    >>> [round(cosine_factor(p, warmup=0.2), 3) for p in (0.0, 0.1, 0.2, 0.6, 1.0, 1.5)]
    [0.0, 0.5, 1.0, 0.5, 0.0, 0.0]
    """
    if progress < warmup:
        return progress / warmup
    fallen = min((progress - warmup) / (1 - warmup), 1.0)
    return 0.5 * (1 + math.cos(math.pi * fallen))


class WallClockSchedule(_RateSchedule):
    """Schedules all learning rates over a time budget, and stops training when it is spent.

    The rates are updated before each batch. Time includes validation. Checkpoints store the time spent, so
    a resumed run has only the rest. Set ``max_epochs`` to -1, or large enough not to end the run first.

    Args:
        seconds: time budget in seconds.
        warmup: fraction of the budget in which the rates rise from 0.
    """

    def __init__(self, seconds: Positive, warmup: Annotated[float, Range(0, 1, below=True)] = 0.03) -> None:
        super().__init__()
        self.seconds = seconds
        self.warmup = warmup
        check_ranges(self)
        self._before = 0.0  # spent before the run was resumed, in seconds
        self._start: float | None = None

    @property
    def elapsed(self) -> float:
        """Seconds spent so far, including those before the run was resumed."""
        return self._before + (monotonic() - self._start if self._start is not None else 0.0)

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Record the learning rates, and start the clock."""
        super().on_train_start(trainer, pl_module)
        self._start = monotonic()
        self._stop_when_spent(trainer)

    def _factor(self, trainer: Trainer) -> float:
        return cosine_factor(self.elapsed / self.seconds, self.warmup)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        """Stop when the budget is spent."""
        self._stop_when_spent(trainer)

    def _stop_when_spent(self, trainer: Trainer) -> None:
        # Clocks differ between processes, and if one process stopped alone, the others would hang.
        spent = trainer.strategy.reduce_boolean_decision(self.elapsed >= self.seconds, all=False)
        trainer.should_stop = trainer.should_stop or spent

    def state_dict(self) -> dict[str, Any]:
        """Return the time spent and the unscaled rates."""
        return {"elapsed": self.elapsed, "rates": self._rates}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue the clock of the resumed run."""
        self._before = float(state_dict["elapsed"])
        self._rates = state_dict["rates"]


def _stable_factor(step: int, warmup: int, cooldown: tuple[int, int] | None = None) -> float:
    """Return the factor of a learning rate: a linear warm-up, then 1, then a cool-down by 1 - sqrt(t).

    Args:
        step: number of batches so far.
        warmup: number of batches over which the factor rises from 0 to 1.
        cooldown: first batch and number of batches of the cool-down; None keeps the factor at 1.

    References:
        Hägele et al. 2024, "Scaling Laws and Compute-Optimal Training Beyond Fixed Training Durations"
        (arXiv 2405.18392), equation 2.

    >>> [_stable_factor(step, warmup=2, cooldown=(5, 4)) for step in (0, 1, 2, 5, 6, 9)]
    [0.5, 1.0, 1.0, 1.0, 0.5, 0.0]
    """
    factor = min((step + 1) / warmup, 1.0) if warmup else 1.0
    if cooldown is not None and step > cooldown[0]:
        start, length = cooldown
        factor *= 1 - min((step - start) / length, 1.0) ** 0.5
    return factor


class StableSchedule(_RateSchedule):
    """Keeps learning rates constant after a warm-up, so that a run can be continued at any time.

    To release weights, resume from a copy of the checkpoint with ``cooldown``. The rates then fall by 1 -
    sqrt(t) from that point, and training stops at the end. The original checkpoint can still be continued
    at the constant rate. Set ``max_epochs`` to -1, or large enough not to end the run first.

    Args:
        warmup: number of batches over which the rates rise from 0.
        cooldown: number of batches of a cool-down that begins with this run; None trains at a constant
            rate.
    """

    def __init__(self, warmup: Count = 200, cooldown: PositiveInt | None = None) -> None:
        super().__init__()
        self.warmup = warmup
        self.cooldown = cooldown
        check_ranges(self)
        self._cooldown_start: int | None = None

    def _factor(self, trainer: Trainer) -> float:
        """Return the factor of the next batch; the first batch of a run with ``cooldown`` starts it."""
        step = trainer.fit_loop.total_batch_idx
        if self.cooldown is not None and self._cooldown_start is None:
            self._cooldown_start = step
        return _stable_factor(step, self.warmup, self._span())

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        """Stop at the end of the cool-down."""
        span = self._span()
        if span is not None and trainer.fit_loop.total_batch_idx + 1 >= sum(span):
            trainer.should_stop = True

    def _span(self) -> tuple[int, int] | None:
        if self.cooldown is None or self._cooldown_start is None:
            return None
        return self._cooldown_start, self.cooldown

    def state_dict(self) -> dict[str, Any]:
        """Return the unscaled rates, and the first batch of a cool-down."""
        return {"rates": self._rates, "cooldown_start": self._cooldown_start}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue the schedule of the resumed run."""
        self._rates = state_dict["rates"]
        self._cooldown_start = state_dict["cooldown_start"]
