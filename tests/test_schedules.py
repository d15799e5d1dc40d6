"""Schedules follow the run: its length, or its validation error."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.callbacks import EarlyStopping, ModelCheckpoint
from torch.optim import Optimizer, RMSprop
from torch.optim.lr_scheduler import CosineAnnealingLR, LRScheduler, OneCycleLR, ReduceLROnPlateau

from normalgan.errors import InputError
from small import gan as make
from small import trainer
from spheres import loader

pytestmark = pytest.mark.filterwarnings(
    "ignore:.*does not have many workers.*",
    "ignore:.*have no `val_dataloader`.*",
    "ignore:.*smaller than the logging interval.*",
    "ignore:.*removed from hparams because it cannot be pickled.*",
    "ignore:.*LeafSpec.*is deprecated.*",
)


class Rates(Callback):
    """Notes the generator's learning rate of each epoch, as a share of the first."""

    def __init__(self, first: float | None = None) -> None:
        self.first = first
        self.seen: list[float] = []

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        first = self.first or trainer.lr_scheduler_configs[0].scheduler.base_lrs[0]
        self.seen.append(trainer.optimizers[0].param_groups[0]["lr"] / first)


@pytest.mark.slow
def test_the_rate_falls_until_the_last_epoch_and_further_if_the_run_is_made_longer(tmp_path: Path) -> None:
    gan = make(lr_scheduler=lambda optimizer: CosineAnnealingLR(optimizer, T_max=2))
    rates = Rates()
    run = trainer(tmp_path, max_epochs=4, callbacks=[rates])
    run.fit(gan, loader())
    assert rates.seen == pytest.approx([1.0, 0.8536, 0.5, 0.1464], abs=1e-4)
    run.save_checkpoint(tmp_path / "last.ckpt")
    longer = Rates()
    resumed = make(lr_scheduler=lambda optimizer: CosineAnnealingLR(optimizer, T_max=2))
    trainer(tmp_path, max_epochs=6, callbacks=[longer]).fit(
        resumed, loader(), ckpt_path=str(tmp_path / "last.ckpt"), weights_only=True
    )
    assert longer.seen == pytest.approx([0.25, 0.067], abs=1e-3)


def plateau(optimizer: Optimizer) -> LRScheduler:
    """Halve the rate after each validation that is not a hundred times better than the best before."""
    return ReduceLROnPlateau(optimizer, factor=0.5, patience=0, threshold=0.99)


@pytest.mark.slow
def test_the_rate_falls_after_a_validation_without_progress(tmp_path: Path) -> None:
    rates = Rates(first=1e-3)
    gan = make(lr_scheduler=plateau, generator_optimizer=partial(RMSprop, lr=1e-3))
    run = trainer(tmp_path, max_epochs=6, callbacks=[rates], check_val_every_n_epoch=2)
    run.fit(gan, loader(), loader())
    assert rates.seen == pytest.approx([1.0, 1.0, 1.0, 1.0, 0.5, 0.5])


def one_cycle(optimizer: Optimizer) -> LRScheduler:
    return OneCycleLR(optimizer, max_lr=1e-3, total_steps=2, cycle_momentum=False)


def out_of_range(optimizer: Optimizer) -> LRScheduler:
    return OneCycleLR(optimizer, max_lr=1e-3, total_steps=3, pct_start=2)


@pytest.mark.parametrize(
    ("schedule", "sentence"),
    [
        (one_cycle, "OneCycleLR has 2 steps, .* the run has 3 epochs; set total_steps"),
        (out_of_range, "lr_scheduler cannot be used: .* pct_start"),
    ],
)
def test_a_schedule_that_cannot_follow_the_run_is_refused_before_it_trains(
    tmp_path: Path, schedule: Callable[[Optimizer], LRScheduler], sentence: str
) -> None:
    gan = make(lr_scheduler=schedule, generator_optimizer=partial(RMSprop, lr=1e-3))
    with pytest.raises(InputError, match=sentence):
        trainer(tmp_path, max_epochs=3).fit(gan, loader())


@pytest.mark.parametrize("callback", [EarlyStopping, ModelCheckpoint])
def test_a_misspelt_monitor_is_refused_before_the_run_trains(
    tmp_path: Path, callback: Callable[..., Callback]
) -> None:
    run = trainer(tmp_path, callbacks=[callback(monitor="val/hints/angular_mea")], enable_checkpointing=True)
    with pytest.raises(
        InputError, match=r"does not log\. Did you mean val/hints/angular_mean\? It logs, after "
    ):
        run.fit(make(), loader(), loader())
    assert run.global_step == 0


@pytest.mark.parametrize(
    ("metric", "mode", "sentence"),
    [
        ("mask_iou", "min", "mask_iou with the mode min, but higher is better; set its mode to max"),
        ("below_11_25", "min", "higher is better"),
        ("angular_mean", "max", "angular_mean with the mode max, but lower is better; set its mode to min"),
    ],
)
@pytest.mark.parametrize("callback", [EarlyStopping, ModelCheckpoint])
def test_the_worst_of_a_metric_is_not_taken_for_its_best(
    tmp_path: Path, callback: Callable[..., Callback], metric: str, mode: str, sentence: str
) -> None:
    stopping = callback(monitor=f"val/no_hints/{metric}", mode=mode)
    run = trainer(tmp_path, callbacks=[stopping], enable_checkpointing=True)
    with pytest.raises(InputError, match=sentence):
        run.fit(make(), loader(), loader())
    assert run.global_step == 0


def test_a_plateau_of_the_other_direction_is_refused(tmp_path: Path) -> None:
    best = ModelCheckpoint(tmp_path, monitor="val/hints/mask_iou", mode="max")
    gan = make(lr_scheduler=plateau, generator_optimizer=partial(RMSprop, lr=1e-3))
    run = trainer(tmp_path, max_epochs=2, callbacks=[best], enable_checkpointing=True)
    with pytest.raises(
        InputError, match=r"has the mode min, .* has max; set mode of model\.lr_scheduler to max"
    ):
        run.fit(gan, loader(), loader())
    assert run.global_step == 0
