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

from normalgan.models import ResidualUNetGenerator

IDLE = {"AVX512": 0.0504}
"""Seconds that the yardstick takes of an idle core, by the core's instructions.

Of the AMD EPYC with AVX-512 of the log's first records: when one of them, timed there on idle cores, was run
again on busy ones, the yardstick took 0.062 seconds and a step 1.24 times as long as then. Costs of other
kinds of core are not corrected: set records there on idle ones.
"""

_EVERY = 4  # steps from one yardstick to the next
_KEPT = {"hints": "val/hints/angular_mean", "no_hints": "val/no_hints/angular_mean"}


class Yardstick:
    """A piece of the track's own work, always the same: how fast a core is just now.

    Work on the other cores slows memory and caches down for this one too: a run was seen to take a third
    more of a core's time than on an idle machine, step for step. What the yardstick takes beside the run
    tells how much of it is the machine's.
    """

    def __init__(self) -> None:
        with torch.random.fork_rng(devices=[]):
            self._network = ResidualUNetGenerator((24, 48, 96, 128, 160), patch=2, norm="batch")
            self._condition = torch.rand(4, 4, 64, 64)

    def seconds(self) -> float:
        """Take the measure once; return the seconds that the process had a core for it."""
        start = time.process_time()
        with torch.enable_grad():
            self._network(self._condition).sum().backward()
        self._network.zero_grad()
        return time.process_time() - start


class Cost(Callback):
    """Writes ``cost.json`` in the folder of the run: seconds of training, images and errors at validations.

    On a processor seconds are those that the process had a core, divided by how much slower than on an idle
    machine the `Yardstick` was meanwhile, for the kinds of core in `IDLE`; on a GPU those by the clock, once
    it has done what it was given. Validation and saving do not count. A run that is resumed goes on counting.
    """

    def __init__(self) -> None:
        self.curve: list[dict[str, float | None]] = []
        self._spent, self._images = 0.0, 0
        self._since: float | None = None
        self._epoch = 0.0  # seconds that the process had a core
        self._yardstick = Yardstick()
        self._measured: list[float] = []

    def _now(self, module: LightningModule) -> float:
        if module.device.type == "cuda":
            torch.cuda.synchronize(module.device)
            return time.perf_counter()
        return time.process_time()

    def _pause(self, module: LightningModule) -> None:
        if self._since is not None:
            self._epoch += self._now(module) - self._since
            self._since = None

    def _slowdown(self, module: LightningModule) -> float | None:
        """Return how many times the time of an idle core the yardstick took since last asked."""
        idle = IDLE.get(torch.backends.cpu.get_cpu_capability()) if module.device.type == "cpu" else None
        measured, self._measured = self._measured, []
        return sum(measured) / len(measured) / idle if idle and measured else None

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Start the clock."""
        self._since = self._now(pl_module)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Any, batch_idx: int
    ) -> None:
        """Count the images; at some steps measure how fast the core is, off the clock."""
        self._images += len(batch["sketch"])
        if pl_module.device.type == "cpu" and batch_idx % _EVERY == 0:
            self._pause(pl_module)
            self._measured.append(self._yardstick.seconds())
            self._since = self._now(pl_module)

    def on_validation_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Stop the clock."""
        self._pause(pl_module)

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Note cost and error, and stop the run if one of them is where it should be."""
        if trainer.sanity_checking:
            return
        slowdown = self._slowdown(pl_module)
        self._spent += self._epoch / (slowdown or 1.0)
        self._epoch = 0.0
        point: dict[str, float | None] = {"cost": round(self._spent, 2), "images": self._images}
        point["slowdown"] = slowdown and round(slowdown, 3)
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
