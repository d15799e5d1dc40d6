"""WallClockSchedule: a cosine schedule over a time budget."""

import math
from time import monotonic
from typing import Annotated, Any

from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch
from normalgan.callbacks.rates import base_rates, scale_rates
from normalgan.errors import InputError
from normalgan.ranges import Positive, Range, check_ranges

__all__ = ["WallClockSchedule", "cosine_factor"]


def cosine_factor(progress: float, warmup: float) -> float:
    """Return the factor of a learning rate: a linear rise, then half a cosine down to 0.

    Args:
        progress: share of the budget that is spent, 0 or more; 0 is returned beyond 1.
        warmup: share of the budget in which the rate rises, at least 0 and below 1.

    >>> [round(cosine_factor(p, warmup=0.2), 3) for p in (0.0, 0.1, 0.2, 0.6, 1.0, 1.5)]
    [0.0, 0.5, 1.0, 0.5, 0.0, 0.0]
    """
    if progress < warmup:
        return progress / warmup
    fallen = min((progress - warmup) / (1 - warmup), 1.0)
    return 0.5 * (1 + math.cos(math.pi * fallen))


class WallClockSchedule(Callback):
    """Schedules all learning rates over a time budget, and stops training at its end.

    The rates are set at every batch. Time includes validation. The checkpoint stores the time spent, so a
    resumed run has the rest. Set ``max_epochs`` to -1, or large enough not to end the run first.

    Args:
        seconds: the budget.
        warmup: share of it in which the rates rise from 0.

    Raises:
        InputError: if ``seconds`` or ``warmup`` is out of range.
    """

    def __init__(self, seconds: Positive, warmup: Annotated[float, Range(0, 1, below=True)] = 0.03) -> None:
        self.seconds = seconds
        self.warmup = warmup
        check_ranges(self)
        self._before = 0.0  # seconds spent by the runs that this one resumes
        self._start: float | None = None
        self._rates: list[list[float]] = []

    @property
    def elapsed(self) -> float:
        """Seconds spent so far, those before an interruption included."""
        return self._before + (monotonic() - self._start if self._start is not None else 0.0)

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Start the clock.

        Raises:
            InputError: if there is another schedule of the learning rates.
        """
        if trainer.lr_scheduler_configs:
            raise InputError(
                "WallClockSchedule sets the learning rates itself; give model.lr_scheduler null."
            )
        if not self._rates:  # the optimisers of a checkpoint hold scaled rates
            self._rates = base_rates(trainer)
        self._start = monotonic()
        self._stop_when_spent(trainer)

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        """Set the learning rates."""
        factor = cosine_factor(self.elapsed / self.seconds, self.warmup)
        scale_rates(trainer, self._rates, factor)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        """Stop when the budget is spent."""
        self._stop_when_spent(trainer)

    def _stop_when_spent(self, trainer: Trainer) -> None:
        # Clocks differ between processes; if one stopped alone, the others would wait for it.
        spent = trainer.strategy.reduce_boolean_decision(self.elapsed >= self.seconds, all=False)
        trainer.should_stop = trainer.should_stop or spent

    def state_dict(self) -> dict[str, Any]:
        """Return the time spent and the unscaled rates."""
        return {"elapsed": self.elapsed, "rates": self._rates}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue the clock of the resumed run."""
        self._before = float(state_dict["elapsed"])
        self._rates = state_dict["rates"]
