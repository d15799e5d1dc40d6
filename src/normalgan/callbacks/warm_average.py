"""WarmAverage: an exponential moving average of the weights."""

from functools import partial
from typing import Annotated, Any

import torch
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import WeightAveraging
from torch import Tensor
from torch.optim.swa_utils import get_ema_multi_avg_fn

from normalgan.models.statistics import average_statistics
from normalgan.ranges import Range, check_ranges


class WarmAverage(WeightAveraging):
    """Validates and saves an exponential moving average of the weights instead of the weights themselves.

    With a constant decay, the untrained weights stay in the average for hundreds of steps, which harms
    short runs. Here the decay after n steps is ``min(decay, (1 + n) / (10 + n))``, so that the average
    covers about the last ninth of the run until ``decay`` is reached (like TensorFlow's
    ``ExponentialMovingAverage`` with ``num_updates``).

    The average is kept on the device of the weights. Batch norm's running statistics are averaged too, and
    before validation or saving also across processes.

    Args:
        decay: final decay, in [0, 1).
    """

    def __init__(self, decay: Annotated[float, Range(0, 1, below=True)] = 0.998) -> None:
        self.decay = decay
        check_ranges(self)
        super().__init__()
        self._steps = 0  # mirrors the average's own counter, which is on the device
        self._pairs: tuple[list[Tensor], list[Tensor]] = ([], [])
        self._counts: list[tuple[Tensor, Tensor]] = []

    def on_fit_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Move the average to the device of the weights."""
        average = self._average()
        average.to(pl_module.device)
        self._steps = int(average.n_averaged)
        averaged = [*average.module.parameters(), *average.module.buffers()]
        pairs = [
            (kept.detach(), current.detach())
            for kept, current in zip(averaged, [*pl_module.parameters(), *pl_module.buffers()], strict=True)
        ]
        self._pairs = (
            [kept for kept, _ in pairs if kept.is_floating_point()],
            [current for kept, current in pairs if kept.is_floating_point()],
        )
        self._counts = [(kept, current) for kept, current in pairs if not kept.is_floating_point()]

    @torch.no_grad()
    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Any, batch_idx: int
    ) -> None:
        """Update the average after a step without a transfer from the device."""
        if trainer.global_step <= self._latest_update_step:
            return
        share = min(self.decay, (1 + self._steps) / (10 + self._steps)) if self._steps else 0.0
        get_ema_multi_avg_fn(share)(*self._pairs, None)
        for kept, current in self._counts:  # such as a counter of batches
            kept.copy_(current)
        self._steps += 1
        self._average().n_averaged += 1
        self._latest_update_step = trainer.global_step

    def on_validation_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Swap in the average, synchronised across processes."""
        self._share_statistics(trainer)
        super().on_validation_epoch_start(trainer, pl_module)

    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Synchronise the average across processes for the checkpoint, in case there was no validation."""
        self._share_statistics(trainer)

    def _share_statistics(self, trainer: Trainer) -> None:
        if self._average_model is not None and trainer.world_size > 1:
            mean = partial(trainer.strategy.reduce, reduce_op="mean")
            average_statistics(self._average_model.module, mean)

    def _average(self) -> Any:
        if self._average_model is None:
            raise RuntimeError("the average is made when fit begins.")
        return self._average_model
