"""LearningCurve: validation metrics over the number of training images, as a file."""

from pathlib import Path
from time import monotonic
from typing import Any

from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch
from normalgan.files.json_files import encode_json
from normalgan.files.writing import write_bytes
from normalgan.gan import ADVERSARIAL_SHARE, NormalGAN


class LearningCurve(Callback):
    """Writes ``curve.json`` to the folder of the run, with one record per validation.

    A record holds ``images``, ``epoch``, ``seconds`` of training so far, the validation metrics, and the
    adversarial gradient's share if it is logged. ``images`` counts the images of the generator's batches
    on all processes, without batches that train only the discriminator. Checkpoints include the records,
    so a resumed run continues them.
    """

    def __init__(self) -> None:
        self.images = 0
        self.records: list[dict[str, float | None]] = []
        self._seconds = 0.0
        self._start: float | None = None

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Start the clock."""
        self._start = monotonic()

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Batch, batch_idx: int
    ) -> None:
        """Count the batch if the generator takes a step on it."""
        if not isinstance(pl_module, NormalGAN):
            raise TypeError(f"LearningCurve counts steps of a NormalGAN, not a {type(pl_module).__name__}.")
        step = trainer.fit_loop.total_batch_idx
        if pl_module.discriminator is None or step % pl_module.n_critic == 0:
            self.images += len(batch["sketch"]) * trainer.world_size

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Add a record."""
        if trainer.sanity_checking or trainer.state.fn != "fit":
            return
        figures = {
            name: float(value) if value.isfinite() else None  # JSON has no nan
            for name, value in trainer.callback_metrics.items()
            if name.startswith("val/") or name == ADVERSARIAL_SHARE
        }
        now = {"images": self.images, "epoch": trainer.current_epoch, "seconds": round(self._spent(), 1)}
        self.records.append({**now, **figures})
        if trainer.is_global_zero:
            write_bytes(Path(trainer.default_root_dir) / "curve.json", encode_json(self.records))

    def _spent(self) -> float:
        return self._seconds + (monotonic() - self._start if self._start is not None else 0.0)

    def state_dict(self) -> dict[str, Any]:
        """Return the state for the checkpoint."""
        return {"images": self.images, "records": self.records, "seconds": self._spent()}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Restore the state from a checkpoint."""
        self.images, self.records = state_dict["images"], state_dict["records"]
        self._seconds = state_dict["seconds"]
