"""The training commands: LightningCLI with our defaults, plug-ins and answers to mistakes."""

import logging
import re
import sys
import warnings
from pathlib import Path
from typing import Any

import torch
from jsonargparse import Namespace
from lightning.pytorch import Trainer
from lightning.pytorch.callbacks import ModelCheckpoint
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI
from lightning.fabric.utilities.exceptions import MisconfigurationException

from normalgan.callbacks import NormalMapWriter, PictureLogger, TestReport
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, brief
from normalgan.gan import NormalGAN
from normalgan.hints import HINT_SAMPLERS
from normalgan.models import DISCRIMINATORS, GENERATORS
from normalgan.objectives import ADVERSARIAL_OBJECTIVES
from normalgan.registry import Registry
from normalgan.rendering.lines import LINE_DRAWINGS
from normalgan.rendering.renderers import RENDERERS

REGISTRIES: dict[str, Registry[Any]] = {
    "renderer": RENDERERS,
    "lines": LINE_DRAWINGS,
    "hint_sampler": HINT_SAMPLERS,
    "generator": GENERATORS,
    "discriminator": DISCRIMINATORS,
    "objective": ADVERSARIAL_OBJECTIVES,
}
"""The registry behind each setting that names a plug-in."""


class RenderingTrainer(Trainer):
    """Lightning's Trainer with one more command."""

    def render(self, model: NormalGAN, datamodule: MeshDataModule) -> None:
        """Render the samples of every split to disk, and stop there."""
        datamodule.prepare_data()


class Parser(LightningArgumentParser):
    """Says a mistake in one sentence, and names the plug-in that a typo may have meant."""

    def error(self, message: str, ex: Exception | None = None) -> None:  # type: ignore[override]
        """Raise `InputError` in place of a usage page."""
        raise InputError(explain(message))


def explain(message: str) -> str:
    """Return jsonargparse's message as one sentence; for an unknown plug-in, with the near miss.

    Args:
        message: several lines, each deeper into the types that were tried.
    """
    # The wrong name may be quoted anywhere in a nested message, so the known settings are looked for.
    for setting, registry in REGISTRIES.items():
        unknown = re.search(rf"\b(?:model|data)\.{setting}\b", message)
        if unknown:
            for given in re.findall(
                r"(?:given value was|Given value:|value) ['\"]?([A-Za-z_][\w.]*)['\"]?", message
            ):
                if given not in registry.names() and "." not in given:
                    return f'argument "{unknown.group()}": {registry.explain_unknown(given)}'
    lines = [line.strip(" -\t") for line in message.strip().splitlines() if line.strip(" -\t")]
    return " ".join(lines) if len(lines) < 3 else f"{lines[0]} {lines[-1]}"


class NormalGANCLI(LightningCLI):
    """fit, validate, test, predict, and render."""

    @staticmethod
    def subcommands() -> dict[str, set[str]]:
        """Return Lightning's commands and ours, with the arguments that are not options."""
        return {**LightningCLI.subcommands(), "render": {"model", "datamodule"}}

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Set the defaults, and the links that keep settings in step."""
        parser.add_lightning_class_args(ModelCheckpoint, "checkpoint")
        parser.add_lightning_class_args(PictureLogger, "pictures")
        parser.add_lightning_class_args(TestReport, "report")
        parser.add_lightning_class_args(NormalMapWriter, "output")
        parser.set_defaults(
            {
                "model.generator": {"class_path": "normalgan.models.UNetGenerator"},
                "model.discriminator": {"class_path": "normalgan.models.UNetDiscriminator"},
                "model.hint_sampler": {"class_path": "normalgan.hints.CurvatureHints"},
                "model.objective": {"class_path": "normalgan.objectives.Wasserstein"},
                "trainer.logger": {
                    "class_path": "lightning.pytorch.loggers.TensorBoardLogger",
                    "init_args": {"save_dir": "runs", "name": "", "version": ""},
                },
                "checkpoint.monitor": "val/hints/angular_mean",
                "checkpoint.filename": "{epoch:03d}-{val/hints/angular_mean:.2f}",
                "checkpoint.auto_insert_metric_name": False,
                "checkpoint.save_last": True,
                "checkpoint.enable_version_counter": False,
            }
        )
        parser.link_arguments("trainer.default_root_dir", "trainer.logger.init_args.save_dir")
        parser.link_arguments("trainer.default_root_dir", "checkpoint.dirpath", compute_fn=checkpoint_folder)
        for network in ("generator", "discriminator"):
            parser.link_arguments("data.size", f"model.{network}.init_args.size")

    def _parse_ckpt_path(self) -> None:
        """Read the checkpoint's settings over the configuration's, after a look at whether it can be used."""
        config = self.config[self.config["subcommand"]]
        path = config.get("ckpt_path")
        if path is None or path in {"best", "last", "hpc", "registry"}:
            return
        check_checkpoint(Path(path), config)
        super()._parse_ckpt_path()

    def before_instantiate_classes(self) -> None:
        """Refuse to train over a finished run."""
        command = self.config["subcommand"]
        config = self.config[command]
        last = Path(checkpoint_folder(config["trainer"].get("default_root_dir"))) / "last.ckpt"
        if command == "fit" and config.get("ckpt_path") is None and last.is_file():
            raise InputError(
                f"{last.parent} holds a run already: resume it with --ckpt_path {last}, "
                "or give another --trainer.default_root_dir."
            )


def checkpoint_folder(root: str | None) -> str:
    """Return where the checkpoints of a run go, by the run's folder."""
    return str(Path(root or ".") / "checkpoints")


def check_checkpoint(path: Path, config: Namespace) -> None:
    """Look at a checkpoint before anything is built for it.

    Args:
        path: the file.
        config: the settings of the command.

    Raises:
        InputError: if it is missing, damaged, not one of ours, or of another configuration.
    """
    if not path.is_file():
        raise InputError(f"there is no checkpoint {path}.")
    try:
        checkpoint = torch.load(path, map_location="cpu", weights_only=True, mmap=True)
    except Exception as error:
        raise InputError(f"{path} is damaged or no checkpoint: {brief(error)}.") from None
    if not isinstance(checkpoint, dict) or not {"state_dict", "hyper_parameters"} <= checkpoint.keys():
        raise InputError(f"{path} holds no checkpoint of normalgan; give one that `normalgan fit` saved.")
    settings = checkpoint["hyper_parameters"]
    for network in ("generator", "discriminator"):
        size = ((settings.get(network) or {}).get("init_args") or {}).get("size")
        if size not in {None, config["data"]["size"]}:
            given = config["data"]["size"]
            raise InputError(f"{path} was trained at {size} pixels, not {given}; give --data.size {size}.")


def run(arguments: list[str]) -> int:
    """Run one of the training commands.

    Raises:
        InputError: if something that was given cannot be used.
    """
    # Advertisements and what hardware there is not: of no use to anyone who waits for a result.
    logging.getLogger("lightning.pytorch.utilities.rank_zero").setLevel(logging.WARNING)
    for registry in REGISTRIES.values():
        registry.load_entry_points()
    # Lightning asks for more data workers than this machine has cores, and for settings we chose on purpose.
    warnings.filterwarnings("ignore", message=r".*does not have many workers.*")
    warnings.filterwarnings("ignore", message=r".*is smaller than the logging interval.*")
    warnings.filterwarnings("ignore", message=r".*LeafSpec.*is deprecated.*")
    warnings.filterwarnings("ignore", message=r"LightningCLI.s args parameter is intended.*")
    try:
        NormalGANCLI(
            NormalGAN,
            MeshDataModule,
            trainer_class=RenderingTrainer,
            save_config_kwargs={"overwrite": True},
            seed_everything_default=0,
            parser_class=Parser,
            auto_configure_optimizers=False,
            args=arguments,
        )
    except MisconfigurationException as error:
        raise InputError(brief(error)) from error
    except SystemExit as stop:  # --help and --print_config end like this
        return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    sys.stdout.flush()
    return 0
