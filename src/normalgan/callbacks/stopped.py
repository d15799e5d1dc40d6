"""StoppedCheckpoint: the checkpoint of a run that is stopped within an epoch."""

import signal
from threading import current_thread, main_thread
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks.checkpoints import stopped_checkpoint
from normalgan.errors import tell
from normalgan.losses.finite import LossError

__all__ = ["StoppedCheckpoint"]


class StoppedCheckpoint(Callback):
    """Saves ``stopped.ckpt`` where a job is preempted (SIGTERM) or a loss is no longer finite.

    ``last.ckpt`` stays the one of the last whole epoch; a run resumed from it ends as if it had never
    stopped. After SIGTERM a run can also resume from ``stopped.ckpt``: it loses no training, but may end with
    different weights. After a loss that is not finite its weights are sound, but batch norm's running
    statistics have seen the batch: use it to look for the cause.

    With several processes, Lightning answers SIGTERM by a message to the others from within the handler. In
    the middle of another exchange this makes all processes wait for one another. Here the handler only sets a
    flag, and the processes agree before each batch.
    """

    def __init__(self) -> None:
        self._asked = False

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Replace Lightning's handler, which restores the earlier one when training ends."""
        if trainer.world_size > 1 and current_thread() is main_thread():
            signal.signal(signal.SIGTERM, self._note)

    def _note(self, *_: object) -> None:
        self._asked = True

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Any, batch_idx: int
    ) -> None:
        """Stop all processes if one was asked to."""
        self._agree(trainer)

    def on_validation_batch_start(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        batch: Any,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        """Stop all processes if one was asked to; all validate equally many batches."""
        if trainer.state.fn == TrainerFn.FITTING and not trainer.sanity_checking:
            self._agree(trainer)

    def _agree(self, trainer: Trainer) -> None:
        if trainer.world_size > 1 and trainer.strategy.reduce_boolean_decision(self._asked, all=False):
            raise SIGTERMException

    def on_exception(self, trainer: Trainer, pl_module: LightningModule, exception: BaseException) -> None:
        """Save the checkpoint and say where."""
        if not isinstance(exception, SIGTERMException | LossError):
            return
        if trainer.sanity_checking or trainer.fast_dev_run:  # type: ignore[attr-defined]  # set from outside
            return
        path = stopped_checkpoint(trainer.default_root_dir)
        trainer.save_checkpoint(path)
        if isinstance(exception, LossError):
            exception.keep(path)
        elif trainer.is_global_zero:
            tell(f"stopped by SIGTERM; resume with --ckpt_path {path}.")
