"""A callback that makes a loss no number."""

import torch
from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch


class SpoilAt(Callback):
    """Puts NaN or infinity into the true normals of a batch.

    Args:
        epoch: in which epoch, from 0.
        batch: in which batch of it, from 0.
        value: what to put there.
    """

    def __init__(self, epoch: int, batch: int, value: float) -> None:
        self.epoch = epoch
        self.batch = batch
        self.value = value
        self.names: list[str] = []

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        """Spoil it, if it is time."""
        if (trainer.current_epoch, batch_idx) == (self.epoch, self.batch):
            with torch.no_grad():
                batch["normal"][0, 0, 16, 16] = self.value
            self.names = batch["name"]
            print("spoilt", *self.names)
