from pathlib import Path

import pytest
from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.batch import Batch
from normalgan.callbacks import StableSchedule
from normalgan.errors import InputError
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)


class Rates(Callback):
    """Notes the generator's learning rate of every batch."""

    def __init__(self) -> None:
        self.seen: list[float] = []

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        self.seen.append(trainer.optimizers[0].param_groups[0]["lr"] / 5e-5)


def test_a_resumed_run_stays_at_the_rate_and_a_cool_down_branches_off(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    stable = tmp_path / "stable.ckpt"
    rates = Rates()
    run = trainer(tmp_path, max_epochs=2, callbacks=[rates, StableSchedule(warmup=4)])
    run.fit(gan(), data(meshes, cache))  # three batches an epoch
    run.save_checkpoint(stable)
    assert rates.seen == pytest.approx([0.25, 0.5, 0.75, 1, 1, 1])

    resumed = Rates()
    run = trainer(tmp_path, max_epochs=3, callbacks=[resumed, StableSchedule(warmup=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=stable)
    assert resumed.seen == pytest.approx([1, 1, 1])

    cooled, halfway = Rates(), tmp_path / "halfway.ckpt"
    run = trainer(tmp_path, max_epochs=3, callbacks=[cooled, StableSchedule(warmup=4, cooldown=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=stable)
    run.save_checkpoint(halfway)
    assert cooled.seen == pytest.approx([1, 0.5, 1 - 0.5**0.5])

    rest = Rates()
    run = trainer(tmp_path, max_epochs=-1, callbacks=[rest, StableSchedule(warmup=4, cooldown=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=halfway)
    assert rest.seen == pytest.approx([1 - 0.75**0.5])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"warmup": -1}, "warmup of StableSchedule is -1"),
        ({"cooldown": 0}, "cooldown of StableSchedule is 0"),
    ],
)
def test_bad_numbers_are_refused(settings: dict[str, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        StableSchedule(**settings)
