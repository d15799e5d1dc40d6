"""A cosine schedule ends with the run."""

from pathlib import Path

import pytest
from lightning.pytorch import Callback, LightningModule, Trainer
from torch.optim.lr_scheduler import CosineAnnealingLR

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

    def __init__(self) -> None:
        self.seen: list[float] = []

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        config = trainer.lr_scheduler_configs[0]
        self.seen.append(trainer.optimizers[0].param_groups[0]["lr"] / config.scheduler.base_lrs[0])


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
