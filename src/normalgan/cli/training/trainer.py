"""The trainer of the training commands: Lightning's with `render`, without settings that have no effect."""

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
from normalgan.errors import InputError
from normalgan.gan import NormalGAN

__all__ = [
    "RenderingTrainer",
    "SaveConfig",
    "check_strategy",
    "check_trainer",
    "check_trains",
    "keep_earlier_logs",
]

_INSTEAD = {
    "gradient_clip_val": "model.gradient_clip",
    "gradient_clip_algorithm": "model.gradient_clip, which is a norm",
    "accumulate_grad_batches": "a larger data.batch_size",
}
"""Settings of the trainer that do nothing under manual optimisation, and what does that instead."""
_LENGTHS = ("max_epochs", "max_steps", "limit_train_batches")
"""Settings of the trainer that say how long to train."""
_PLAIN_DDP = ("auto", "ddp", "ddp_spawn", "ddp_fork", "ddp_notebook")
"""Names under which several processes do not look for parameters that a step leaves untouched."""
_OF_A_COMMAND = ("ckpt_path", "weights_only")
"""Settings of one command, not of its run."""
_LOGS = "lightning_logs"
"""Where Lightning's loggers write by default, in the run's folder."""
_DEVICES: Mapping[str, tuple[type[Accelerator], ...]] = {
    "gpu": (CUDAAccelerator, MPSAccelerator),
    "cuda": (CUDAAccelerator,),
    "mps": (MPSAccelerator,),
    "tpu": (XLAAccelerator,),
}
"""The devices that each name of an accelerator may mean; the processor is always there."""


def check_trainer(settings: Mapping[str, Any]) -> None:
    """Refuse settings that do not work with manual optimisation, and a device that is not there.

    Raises:
        InputError: if such a setting was given; the sentence names the one to use.
    """
    for name, instead in _INSTEAD.items():
        if settings[name] not in {None, 1 if name == "accumulate_grad_batches" else None}:
            raise InputError(
                f"trainer.{name} cannot be used, because optimisers are stepped by hand; use {instead}."
            )
    wanted = settings["accelerator"]
    devices = _DEVICES.get(wanted, ()) if isinstance(wanted, str) else ()
    if devices and not any(each.is_available() for each in devices):
        raise InputError(
            f"trainer.accelerator is {wanted}, which PyTorch {torch.__version__} does not find on this "
            "machine; use cpu or auto, or install a build of PyTorch for it."
        )


def check_trains(settings: Mapping[str, Any]) -> None:
    """Refuse settings that train nothing, under which ``fit`` would end as if it had trained.

    Raises:
        InputError: if there is one.
    """
    for name in _LENGTHS:
        if settings[name] == 0:
            raise InputError(
                f"trainer.{name} is 0, so fit would train nothing; give more, or leave it out. "
                "To make the samples only, use normalgan render."
            )


def check_strategy(trainer: Trainer, given: object) -> None:
    """Refuse to train two networks by plain DDP, which Lightning also takes for several devices by itself.

    Args:
        trainer: the trainer.
        given: the setting of its strategy.

    Raises:
        InputError: if it would; it ends with an error at the first step.
    """
    if isinstance(trainer.strategy, DDPStrategy) and given in _PLAIN_DDP:
        name = "auto (ddp)" if given == "auto" else given
        raise InputError(
            f"trainer.strategy is {name}, which cannot train generator and discriminator, because each step "
            "leaves one of them untouched; add --config ddp, or pass --trainer.strategy "
            "ddp_find_unused_parameters_true."
        )


def keep_earlier_logs(settings: Mapping[str, Any]) -> None:
    """Let each command log into a ``metrics.csv`` of its own: ``lightning_logs/version_N``.

    Our default for TensorBoard, the run's folder itself, stays when another logger is named. A CSVLogger
    deletes the table that it finds there: a resumed run or a test would delete what was logged before.

    Args:
        settings: the trainer's; changed.
    """
    given = settings["logger"]
    for logger in given if isinstance(given, list) else [given]:
        if not isinstance(logger, Namespace) or not logger["class_path"].endswith(f".{CSVLogger.__name__}"):
            continue
        inside = logger["init_args"]
        if inside.get("version") == "":
            inside["name"], inside["version"] = _LOGS, None


class RenderingTrainer(Trainer):
    """How and where to train: Lightning's Trainer."""

    def render(self, model: NormalGAN, datamodule: MeshDataModule, cluster: str | None = None) -> None:
        """Render the samples of every split to disk, and stop there.

        Args:
            model: not used.
            datamodule: which samples.
            cluster: a Dask cluster to render on instead of this machine: tcp://host:port, a scheduler file
                (.json), or local:N for N processes here.
        """
        datamodule.render(cluster)


class SaveConfig(SaveConfigCallback):
    """Saves the settings of training in the run's folder; a later test does not overwrite them."""

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Write them when training starts."""
        if stage == "fit":
            super().setup(trainer, pl_module, stage)

    def save_config(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Write the settings into the run's folder, wherever its loggers write.

        The checkpoint that was resumed is left out, so that the settings start a new run, and a later command
        can name its own checkpoint.
        """
        path = Path(trainer.default_root_dir) / self.config_filename
        path.parent.mkdir(parents=True, exist_ok=True)
        settings = self.config.clone()
        for name in _OF_A_COMMAND:
            settings.pop(name, None)
        self.parser.save(settings, path, skip_unset=False, overwrite=True, multifile=self.multifile)

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Write the batch size that is used, if a callback such as BatchSizeFinder has changed it."""
        size = getattr(getattr(trainer, "datamodule", None), "batch_size", None)
        if self.config is None or size is None or self.config["data"]["batch_size"] == size:
            return
        self.config["data"]["batch_size"] = size
        self.already_saved = False
        super().setup(trainer, pl_module, "fit")
