"""PictureLogger: the generator's predictions in TensorBoard or Weights & Biases during training."""

from io import BytesIO

import numpy as np
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.loggers import TensorBoardLogger, WandbLogger
from lightning.pytorch.utilities import rank_zero_only
from PIL import Image

from normalgan.batch import Batch
from normalgan.callbacks.gallery import batch_row, draw_gallery
from normalgan.data.datamodule import MeshDataModule
from normalgan.gan import NormalGAN
from normalgan.ranges import PositiveInt, check_ranges


class PictureLogger(Callback):
    """Logs a gallery of the first samples of the validation split.

    Args:
        every_n_epochs: interval in epochs.
        samples: number of rows, at most the batch size.
    """

    def __init__(self, every_n_epochs: PositiveInt = 5, samples: PositiveInt = 4) -> None:
        self.every_n_epochs = every_n_epochs
        self.samples = samples
        check_ranges(self)

    @rank_zero_only
    def on_validation_batch_end(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        outputs: object,
        batch: Batch,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        """Log the gallery of the first batch if it is due in this epoch."""
        due = (trainer.current_epoch + 1) % self.every_n_epochs == 0
        loggers = [log for log in trainer.loggers if isinstance(log, TensorBoardLogger | WandbLogger)]
        if batch_idx or trainer.sanity_checking or not due or not loggers:
            return
        if not isinstance(pl_module, NormalGAN):
            raise TypeError(
                f"PictureLogger draws the predictions of a NormalGAN, not a {type(pl_module).__name__}."
            )
        hints = pl_module.measured_hints(batch)
        preds = pl_module(batch["sketch"], hints)
        data = getattr(trainer, "datamodule", None)
        of_pairs = isinstance(data, MeshDataModule) and data.of_pairs
        shown = range(min(self.samples, len(preds)))
        rows = [batch_row(batch, i, hints, preds, of_pairs) for i in shown]
        with Image.open(BytesIO(draw_gallery(rows))) as png:
            picture = np.asarray(png.convert("RGB"))
        for logger in loggers:
            if isinstance(logger, WandbLogger):
                logger.log_image("val/gallery", [picture])
            else:
                logger.experiment.add_image("val/gallery", picture, trainer.current_epoch, dataformats="HWC")
