"""NormalMapWriter: what `normalgan predict` leaves on disk."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryFile

import numpy as np
import torch
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import BasePredictionWriter
from torch import Tensor

from normalgan.batch import Sketches
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, unwritable
from normalgan.normals import Bits, normalize, paint_flat, write_png


class NormalMapWriter(BasePredictionWriter):
    """Writes ``<name>_normal.png`` for each sketch, at the sketch's own size; flat off the object.

    The generator was taught vectors of no length where there is no object; what it paints shorter than
    half a unit is taken for background.

    Args:
        folder: where the maps go.
        bits: of each channel, 8 or 16.
    """

    def __init__(self, folder: str = "normals", bits: Bits = 8) -> None:
        super().__init__(write_interval="batch")
        if bits not in {8, 16}:
            raise InputError(f"the bits of a normal map are 8 or 16, not {bits}.")
        self.folder = Path(folder)
        self.bits: Bits = bits

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Make sure that the folder can be written before anything is computed.

        Raises:
            InputError: if it cannot.
        """
        if stage != "predict":
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            # Only an attempt tells: permissions do not say that a disk is full or mounted read-only.
            with TemporaryFile(dir=self.folder) as probe:
                probe.write(b"0")
        except OSError as error:
            raise unwritable(
                f"the normal maps cannot be written to {self.folder}: {error.strerror}.", error
            ) from None

    def write_on_batch_end(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        prediction: Tensor,
        batch_indices: Sequence[int] | None,
        batch: Sketches,
        batch_idx: int,
        dataloader_idx: int,
    ) -> None:
        """Write the maps of one batch, each whole or not at all."""
        data = getattr(trainer, "datamodule", None)
        if not isinstance(data, MeshDataModule):
            raise TypeError(
                "NormalMapWriter needs the MeshDataModule, which knows the frames of the sketches."
            )
        for name, painted in zip(batch["name"], prediction, strict=True):
            vectors = painted.permute(1, 2, 0).to("cpu", torch.float32).numpy()
            vectors = data.frame(name).restore(vectors)
            mask = np.linalg.norm(vectors, axis=-1) > 0.5
            write_png(self.folder / f"{name}_normal.png", paint_flat(normalize(vectors), mask), self.bits)

    def on_predict_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Say where the maps are."""
        if trainer.is_global_zero:
            print(f"Normal maps: {self.folder.resolve()}")
