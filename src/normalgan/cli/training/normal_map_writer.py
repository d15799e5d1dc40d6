"""NormalMapWriter: write the maps of `normalgan predict`."""

from collections.abc import Sequence
from pathlib import Path

import torch
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import BasePredictionWriter
from torch import Tensor

from normalgan.batch import Sketches
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, RunError, printable, tell, with_subject, writing
from normalgan.files.writing import probe
from normalgan.gan import NormalGAN
from normalgan.inference.jobs.plan import Job, plan
from normalgan.inference.jobs.writing import Writer
from normalgan.inference.network.torch_backend import channels_last
from normalgan.inference.network.upsampling import enlarge, upsampler
from normalgan.inference.outputs.output_set import Outputs
from normalgan.inference.pipeline import finish


class NormalMapWriter(BasePredictionWriter):
    """Writes ``<name>_normal.png`` for each sketch, at the sketch's own size and flat off the object.

    Args:
        folder: output folder.
        outputs: outputs to write; None writes the map as PNG.
        strength: factor applied to the slopes of the map.
    """

    def __init__(
        self, folder: str | Path = "normals", outputs: Outputs | None = None, strength: float = 1.0
    ) -> None:
        super().__init__(write_interval="batch")
        self.folder = Path(folder)
        self.outputs = outputs or Outputs()
        self._writer = Writer(self.outputs)
        self.strength = strength
        self._jobs: dict[str, Job] = {}
        self._failed = self._total = 0
        self._upsample = enlarge

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Check that the maps can be written before anything is computed.

        Raises:
            InputError: if they cannot be written.
        """
        if stage != "predict":
            return
        # A third-party module has no refiner.
        refined = isinstance(pl_module, NormalGAN) and pl_module.refined
        self._upsample = upsampler(refined=refined, threads=torch.get_num_threads())
        drawings = _data_of(trainer).drawings
        jobs = plan(drawings.files, self.folder, self.outputs.ending, self.outputs.other_endings)
        self._jobs = {job.files.drawing.stem: job for job in jobs}
        self._writer.held.clear()
        self._failed, self._total = 0, len(jobs) + len(drawings.unusable)
        with writing("the normal maps", self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            probe(self.folder)
        for sentence in drawings.unusable:
            self._leave_out(sentence)

    def _leave_out(self, sentence: InputError) -> None:
        self._failed += 1
        tell(sentence)

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
        """Write the outputs of a batch of drawings, each file atomically.

        Raises:
            InputError: if the only drawing is invalid; if there are several, an invalid one is reported and
                skipped.
        """
        drawings = _data_of(trainer).drawings
        for name, preds in zip(batch["name"], prediction, strict=True):
            job = self._jobs[name]
            try:
                predicted = finish(drawings.prepared(name), channels_last(preds), None, self._upsample)
            except InputError as error:
                sentence = with_subject(job.files.drawing, error)
                if self._total == 1:
                    raise sentence from error
                self._leave_out(sentence)
                continue
            self._writer.write(job, predicted.stronger(self.strength))
            if predicted.warning:
                tell(f"warning: {job.files.drawing}: {predicted.warning}.")

    def on_predict_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Print where the maps are.

        Raises:
            RunError: if some of several drawings were invalid.
        """
        self._writer.write_held()
        if trainer.is_global_zero:
            print(printable(f"Normal maps: {self.folder.resolve()}"))
        if self._failed:
            raise RunError(f"{self._failed} of {self._total} sketches could not be used.")


def _data_of(trainer: Trainer) -> MeshDataModule:
    data = getattr(trainer, "datamodule", None)
    if not isinstance(data, MeshDataModule):
        raise TypeError("NormalMapWriter needs the MeshDataModule, which knows the drawings.")
    return data
