"""What fit says on a terminal or in a file."""

import logging
from pathlib import Path

import pytest
from command import Bench
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import EarlyStopping, RichProgressBar
from lightning.pytorch.loggers import CSVLogger, Logger

from normalgan.callbacks.display import WideProgressBar
from normalgan.warning_filters import filter_warnings


@pytest.mark.slow
def test_fit_says_why_it_stopped_what_a_profiler_measured_and_which_checkpoint_is_best(
    bench: Bench, tmp_path: Path
) -> None:
    done = bench.run(
        "fit",
        tmp_path / "run",
        *("--trainer.max_epochs", 4, "--trainer.profiler", "simple", "--trainer.enable_progress_bar", "true"),
        *("--trainer.callbacks", "EarlyStopping", "--trainer.callbacks.monitor", "val/hints/angular_mean"),
        *("--trainer.callbacks.patience", 1, "--trainer.callbacks.min_delta", 100),
    )
    assert done.code == 0, done.err
    metric = "val/hints/angular_mean"
    stopped = f"Training stopped early. Monitored metric {metric} did not improve in the last 1 records."
    assert stopped in done.out
    assert "run_training_epoch" in done.err  # the profiler's table
    assert "GPU available" not in done.err
    (best,) = (path for path in (tmp_path / "run" / "checkpoints").glob("0*.ckpt"))
    assert f"The best checkpoint is {best} (val/hints/angular_mean " in done.out
    assert "FLOPs" not in done.out
    assert "generator: UNetGenerator, 65.9 thousand parameters" in done.out
    assert "Epoch 2/4" in done.out  # counted from 1
    assert "train/discriminator: " in done.out.replace("\n", "")  # not cut at 80 columns


@pytest.mark.slow
@pytest.mark.parametrize(
    ("setting", "value"),
    [("trainer.limit_val_batches", 0), ("trainer.check_val_every_n_epoch", 5), ("checkpoint.save_top_k", 0)],
)
def test_fit_says_why_no_checkpoint_is_the_best(
    bench: Bench, tmp_path: Path, setting: str, value: int
) -> None:
    done = bench.run("fit", tmp_path / "run", "--trainer.max_epochs", 1, f"--{setting}", value)
    assert done.code == 0, done.err
    last = tmp_path / "run" / "checkpoints" / "last.ckpt"
    told = f"No checkpoint is the best, because no epoch was validated; the last one is {last}.\n" in done.out
    assert told == ("val" in setting)  # none is wanted if the best 0 are kept
    assert "is the best, because" not in done.out or told
    assert "Did you call" not in done.err


class Many(Logger):
    """A logger that keeps nothing, beside another one."""

    name = "many"
    version = 7

    def log_metrics(self, metrics: object, step: object = None) -> None: ...

    def log_hyperparams(self, params: object, *args: object, **kwargs: object) -> None: ...


def test_the_progress_bar_shows_losses_and_no_version_of_several_loggers(tmp_path: Path) -> None:
    trainer = Trainer(logger=[Many(), CSVLogger(tmp_path)], accelerator="cpu", enable_progress_bar=False)
    model = LightningModule()
    assert RichProgressBar().get_metrics(trainer, model) == {"v_num": "7_0"}
    assert WideProgressBar().get_metrics(trainer, model) == {}


def test_lightnings_log_of_the_machine_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    filter_warnings()
    for text in (
        "GPU available: False, used: False",
        "Seed set to 0",
        "Restored all states from the checkpoint at x",
    ):
        logging.getLogger("lightning.pytorch.utilities.rank_zero").info(text)
    logging.getLogger(EarlyStopping.__module__).info("Signaling Trainer to stop.")
    assert capsys.readouterr().err == "normalgan: Signaling Trainer to stop.\n"
