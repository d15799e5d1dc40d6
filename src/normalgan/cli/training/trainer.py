"""The trainer of the training commands: Lightning's Trainer with `render`, and checks of its settings."""

import linecache
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from jsonargparse import Namespace
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.accelerators import Accelerator, CUDAAccelerator, MPSAccelerator, XLAAccelerator
from lightning.pytorch.cli import SaveConfigCallback
from lightning.pytorch.loggers import CSVLogger
from lightning.pytorch.strategies import DDPStrategy

from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, third_party_place
from normalgan.gan import NormalGAN

_INSTEAD = {
    "gradient_clip_val": "model.gradient_clip",
    "gradient_clip_algorithm": "model.gradient_clip, which is a norm",
    "accumulate_grad_batches": "a larger data.batch_size",
}
"""Trainer settings that have no effect under manual optimisation, and what to use instead."""
_LENGTHS = {
    "fit": ("max_epochs", "max_steps", "limit_train_batches"),
    "validate": ("limit_val_batches",),
    "test": ("limit_test_batches",),
}
"""Trainer settings that limit what a command trains on or measures."""
_PLAIN_DDP = ("auto", "ddp", "ddp_spawn", "ddp_fork", "ddp_notebook")
"""Names of strategies that do not look for parameters unused in a step."""
_OF_A_COMMAND = ("ckpt_path", "weights_only")
"""Settings of a command that are not saved with its run."""
_LOGS = "lightning_logs"
"""Default subfolder of Lightning's loggers in the run's folder."""
_DEVICES: Mapping[str, tuple[type[Accelerator], ...]] = {
    "gpu": (CUDAAccelerator, MPSAccelerator),
    "cuda": (CUDAAccelerator,),
    "mps": (MPSAccelerator,),
    "tpu": (XLAAccelerator,),
}
"""The devices that an accelerator's name may stand for; the CPU is always available."""


def check_trainer(settings: Mapping[str, Any], command: str) -> None:
    """Check that settings suit manual optimisation and this machine, and that the command does anything.

    Without batches, a command would end as if it had trained or measured.

    Raises:
        InputError: if a setting does not work; the message names what to use instead.
    """
    for name, instead in _INSTEAD.items():
        if settings[name] not in {None, 1 if name == "accumulate_grad_batches" else None}:
            raise InputError(f"trainer.{name} cannot be used, because optimisation is manual; use {instead}.")
    wanted = settings["accelerator"]
    devices = _DEVICES.get(wanted, ()) if isinstance(wanted, str) else ()
    if devices and not any(each.is_available() for each in devices):
        raise InputError(
            f"trainer.accelerator is {wanted}, which PyTorch {torch.__version__} does not find on this "
            "machine; use cpu or auto, or install a build of PyTorch for it."
        )
    does, more = "measure", ""
    if command == "fit":
        does, more = "train", " To only render samples, use normalgan render."
    for name in _LENGTHS.get(command, ()):
        if settings[name] == 0:
            raise InputError(
                f"trainer.{name} is 0, so {command} would {does} nothing; increase or omit it.{more}"
            )


def check_strategy(trainer: Trainer, given: object) -> None:
    """Check that two networks are not trained with plain DDP, Lightning's default for several devices.

    Args:
        trainer: the trainer.
        given: setting of the strategy.

    Raises:
        InputError: if the strategy is plain DDP, which fails at the first step.
    """
    if isinstance(trainer.strategy, DDPStrategy) and given in _PLAIN_DDP:
        name = "auto (ddp)" if given == "auto" else given
        raise InputError(
            f"trainer.strategy is {name}, which cannot train generator and discriminator, because each step "
            "leaves one of them untouched; add --config ddp, or pass --trainer.strategy "
            "ddp_find_unused_parameters_true."
        )


def refused_by_lightning(error: Exception) -> bool:
    """Return whether a statement of Lightning raised an error, which it does about its settings.

    Errors that PyTorch raises within a call from Lightning, or that our classes and plug-ins raise, are not.
    """
    frames = list(traceback.walk_tb(error.__traceback__))
    frame, line = frames[-1]
    of_lightning = str(frame.f_globals.get("__name__")).startswith("lightning.")
    stated = linecache.getline(frame.f_code.co_filename, line).lstrip().startswith("raise ")
    return of_lightning and stated and third_party_place(error) is None


def validation_first(reason: str) -> str:
    """Return a message of Lightning with the metrics of validation first, because long lists are shortened.

    >>> validation_first("use any of the following: `l1`, `val/own`")
    'use any of the following: `val/own`, `l1`'
    """
    said, mark, names = reason.partition("any of the following: ")
    return said + mark + ", ".join(sorted(names.split(", "), key=lambda name: not name.startswith("`val/")))


def keep_earlier_logs(settings: Mapping[str, Any]) -> None:
    """Let each command log to its own ``lightning_logs/version_N/metrics.csv``.

    Our default folder for TensorBoard, the run's folder itself, remains set when another logger is named. A
    CSVLogger deletes an existing table there, so a resumed run or a test would delete earlier logs.

    Args:
        settings: settings of the trainer; changed in place.
    """
    given = settings["logger"]
    for logger in given if isinstance(given, list) else [given]:
        if not isinstance(logger, Namespace) or not logger["class_path"].endswith(f".{CSVLogger.__name__}"):
            continue
        inside = logger["init_args"]
        if inside.get("version") == "":
            inside["name"], inside["version"] = _LOGS, None


class RenderingTrainer(Trainer):
    """Lightning's Trainer, with a `render` command."""

    def render(self, model: NormalGAN, datamodule: MeshDataModule, cluster: str | None = None) -> None:
        """Render the samples of all splits to disk without training.

        Args:
            model: not used.
            datamodule: data module whose samples are rendered.
            cluster: Dask cluster to render on instead of this machine: tcp://host:port, a scheduler file
                (.json), or local:N for N local processes.
        """
        datamodule.render(cluster)


class SaveConfig(SaveConfigCallback):
    """Saves the settings of training in the run's folder, where a later test does not overwrite them."""

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Save the settings when training starts."""
        if stage == "fit":
            super().setup(trainer, pl_module, stage)

    def save_config(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Write the settings to the run's folder, regardless of where its loggers write.

        The path of a resumed checkpoint is left out, so that the settings start a new run and a later command
        can name its own checkpoint.
        """
        path = Path(trainer.default_root_dir) / self.config_filename
        path.parent.mkdir(parents=True, exist_ok=True)
        settings = self.config.clone()
        for name in _OF_A_COMMAND:
            settings.pop(name, None)
        self.parser.save(settings, path, skip_unset=False, overwrite=True, multifile=self.multifile)

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Update the saved batch size if a callback such as BatchSizeFinder has changed it."""
        size = getattr(getattr(trainer, "datamodule", None), "batch_size", None)
        if self.config is None or size is None or self.config["data"]["batch_size"] == size:
            return
        self.config["data"]["batch_size"] = size
        self.already_saved = False
        super().setup(trainer, pl_module, "fit")
