"""A callback that sends this process a signal, as a user, a cluster or a full memory does."""

import os
import signal
import time

from lightning.pytorch import Callback, LightningModule, Trainer


class KillAt(Callback):
    """Sends a signal after a batch.

    Args:
        epoch: in which epoch, from 0.
        batch: after which batch of it, from 0.
        number: of the signal; SIGKILL ends the process at once, with nothing tidied up.
    """

    def __init__(self, epoch: int, batch: int, number: int = int(signal.SIGKILL)) -> None:
        self.epoch = epoch
        self.batch = batch
        self.number = number

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: object, batch_idx: int
    ) -> None:
        """Send it, if it is time."""
        if (trainer.current_epoch, batch_idx) == (self.epoch, self.batch):
            os.kill(os.getpid(), self.number)


class KillInDestructorAt(KillAt):
    """Sends a signal while an object is destroyed, where Python drops the exception of its handler."""

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: object, batch_idx: int
    ) -> None:
        """Send it, if it is time."""
        if (trainer.current_epoch, batch_idx) == (self.epoch, self.batch):
            _Sender(self.number)


class _Sender:
    def __init__(self, number: int) -> None:
        self.number = number

    def __del__(self) -> None:
        os.kill(os.getpid(), self.number)
        time.sleep(0)  # lets the handler run
