"""Runs that stop by a number of steps, and go on: the same as one that never stopped."""

from functools import partial
from pathlib import Path
from typing import Any

import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from torch.optim.lr_scheduler import StepLR

from normalgan.batch import Batch
from normalgan.callbacks.checkpoints import LastCheckpoint
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET, "ignore:Checkpoint directory .* exists and is not empty")
BATCHES = 3
"""Of an epoch; each takes a step of both optimisers."""
LAST = Path("checkpoints") / "last.ckpt"


class Seen(Callback):
    """Notes the batch, the epoch and the rate of each step."""

    def __init__(self) -> None:
        self.steps: list[tuple[int, int, float]] = []

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        rate = float(trainer.optimizers[0].param_groups[0]["lr"])
        self.steps.append((trainer.fit_loop.total_batch_idx, trainer.current_epoch, rate))


def run(
    folder: Path, meshes: Path, cache: Path, resume: Path | None = None, **until: Any
) -> tuple[dict[str, torch.Tensor], list[tuple[int, int, float]]]:
    """Train, and return what `last.ckpt` holds and the steps that were taken."""
    seen, last = Seen(), folder / LAST
    model = gan(lr_scheduler=partial(StepLR, step_size=1, gamma=0.5))
    trainer(folder, callbacks=[seen, LastCheckpoint()], enable_checkpointing=True, **until).fit(
        model, data(meshes, cache), ckpt_path=resume
    )
    found: dict[str, torch.Tensor] = torch.load(last, weights_only=True)["state_dict"]
    return found, seen.steps


@pytest.mark.slow
@pytest.mark.parametrize(("stop", "epochs"), [(BATCHES, -1), (BATCHES + 1, 9), (2 * BATCHES - 1, -1)])
def test_a_run_that_max_steps_stops_and_that_goes_on_is_an_unbroken_one(
    meshes: Path, cache: Path, tmp_path: Path, stop: int, epochs: int
) -> None:
    end = 3 * BATCHES + 2
    until: dict[str, Any] = {"max_epochs": epochs, "max_steps": 2 * end}
    weights, steps = run(tmp_path / "whole", meshes, cache, **until)
    _, first = run(tmp_path / "parts", meshes, cache, **until | {"max_steps": 2 * stop})
    found, rest = run(tmp_path / "parts", meshes, cache, tmp_path / "parts" / LAST, **until)
    assert len(first) == stop
    assert first + rest == steps
    for name, tensor in weights.items():
        assert torch.equal(found[name], tensor), name
