"""Cost: what training has cost so far beside the validation error, and when that is enough.

A callback of benchmarks/speedrun.py, which says in ``stop.json`` when a run is to end. It lies in a module of
its own, as `normalgan fit` imports it by name.
"""

import json
import time
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch import Callback, LightningModule, Trainer

_KEPT = {"hints": "val/hints/angular_mean", "no_hints": "val/no_hints/angular_mean"}


class Cost(Callback):
    """Writes ``cost.json`` in the folder of the run: seconds of training, images and errors at validations.

    On a processor seconds are those that the process had a core; on a GPU those by the clock, once it has
    done what it was given. Validation and saving do not count. A run that is resumed goes on counting.
    """

    def __init__(self) -> None:
        self.curve: list[dict[str, float | None]] = []
        self._spent, self._images = 0.0, 0
        self._since: float | None = None

    def _now(self, module: LightningModule) -> float:
        if module.device.type == "cuda":
            torch.cuda.synchronize(module.device)
            return time.perf_counter()
        return time.process_time()

    def _pause(self, module: LightningModule) -> None:
        if self._since is not None:
            self._spent += self._now(module) - self._since
            self._since = None

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Start the clock."""
        self._since = self._now(pl_module)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Any, batch_idx: int
    ) -> None:
        """Count the images."""
        self._images += len(batch["sketch"])

    def on_validation_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Stop the clock."""
        self._pause(pl_module)

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Note cost and error, and stop the run if one of them is where it should be."""
        if trainer.sanity_checking:
            return
        point: dict[str, float | None] = {"cost": round(self._spent, 2), "images": self._images}
        for name, figure in _KEPT.items():
            value = trainer.callback_metrics[figure]
            point[name] = round(float(value), 4) if value.isfinite() else None
        self.curve.append(point)
        folder = Path(trainer.default_root_dir)
        partly = folder / "cost.tmp"
        partly.write_text(json.dumps(self.curve) + "\n", encoding="utf-8")
        partly.replace(folder / "cost.json")
        stop = json.loads((folder / "stop.json").read_text(encoding="utf-8"))
        reached = point["hints"] is not None and point["hints"] <= stop["target"]
        if reached or (stop["most"] is not None and self._spent >= stop["most"]):
            trainer.should_stop = True

    def state_dict(self) -> dict[str, Any]:
        """Return what the checkpoint keeps."""
        return {"curve": self.curve, "spent": self._spent, "images": self._images}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Go on where the checkpoint was saved."""
        self.curve, self._spent = state_dict["curve"], state_dict["spent"]
        self._images = state_dict["images"]
