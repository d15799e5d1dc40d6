"""StableSchedule: a constant learning rate that a run can continue, and a short cool-down for a release."""

from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch
from normalgan.callbacks.rates import base_rates, scale_rates
from normalgan.errors import InputError
from normalgan.ranges import Count, PositiveInt, check_ranges

__all__ = ["StableSchedule", "stable_factor"]


def stable_factor(step: int, warmup: int, cooldown: tuple[int, int] | None = None) -> float:
    """Return the factor that a learning rate is multiplied by: a straight rise, 1, then 1 - sqrt(t).

    Args:
        step: batches so far, 0 or more.
        warmup: batches over which the factor rises from 0 to 1.
        cooldown: first batch and number of batches of the cool-down; None keeps the factor at 1.

    References:
        Hägele et al. 2024, "Scaling Laws and Compute-Optimal Training Beyond Fixed Training Durations"
        (arXiv 2405.18392), equation 2.

    >>> [stable_factor(step, warmup=2, cooldown=(5, 4)) for step in (0, 1, 2, 5, 6, 9)]
    [0.5, 1.0, 1.0, 1.0, 0.5, 0.0]
    """
    factor = min((step + 1) / warmup, 1.0) if warmup else 1.0
    if cooldown is not None and step > cooldown[0]:
        start, length = cooldown
        factor *= 1 - min((step - start) / length, 1.0) ** 0.5
    return factor


class StableSchedule(Callback):
    """Keep learning rates constant after a warm-up, so that a run can continue at any time.

    To release weights, resume a copy of the checkpoint with ``cooldown``: the rates then fall by 1 - sqrt(t)
    from that point, and training stops. The checkpoint before the cool-down continues the constant rate.
    Set ``max_epochs`` to -1, or large enough not to end the run first.

    Args:
        warmup: batches over which the rates rise from 0.
        cooldown: batches of the cool-down that begins with this run; None trains at a constant rate.

    Raises:
        InputError: if ``warmup`` is negative or ``cooldown`` is not positive.
    """

    def __init__(self, warmup: Count = 200, cooldown: PositiveInt | None = None) -> None:
        self.warmup = warmup
        self.cooldown = cooldown
        check_ranges(self)
        self._cooldown_start: int | None = None
        self._rates: list[list[float]] = []

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Note the rates of the optimisers.

        Raises:
            InputError: if there is another schedule of the learning rates.
        """
        if trainer.lr_scheduler_configs:
            raise InputError("StableSchedule sets the learning rates itself; set model.lr_scheduler to null.")
        if not self._rates:  # the optimisers of a checkpoint hold rates that are already scaled
            self._rates = base_rates(trainer)

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        """Set the learning rates; the first batch of a run with ``cooldown`` starts it."""
        if self.cooldown is not None and self._cooldown_start is None:
            self._cooldown_start = trainer.fit_loop.total_batch_idx
        factor = stable_factor(trainer.fit_loop.total_batch_idx, self.warmup, self._span())
        scale_rates(trainer, self._rates, factor)

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
        """Return the unscaled rates, and where a cool-down started."""
        return {"rates": self._rates, "cooldown_start": self._cooldown_start}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Continue the schedule of the run that is resumed."""
        self._rates = state_dict["rates"]
        self._cooldown_start = state_dict["cooldown_start"]
