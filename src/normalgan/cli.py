"""The training commands: LightningCLI with our defaults, plug-ins and answers to mistakes."""

import signal
import sys
import warnings
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from textwrap import shorten
from typing import Any

import yaml
from jsonargparse import get_loader, set_loader
from lightning.fabric.utilities.exceptions import MisconfigurationException
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import ModelCheckpoint
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI, SaveConfigCallback
from lightning.pytorch.utilities import rank_zero_only
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks import NormalMapWriter, PictureLogger, StoppedCheckpoint, TestReport
from normalgan.checkpoints import LastCheckpoint, check_unused, check_writable, checkpoint_folder, run_folder
from normalgan.config_files import ConfigCheck, load_bounded
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, brief
from normalgan.gan import NormalGAN
from normalgan.loading import ModelLoader
from normalgan.parser import Parser, with_shipped_configs
from normalgan.parser_errors import refusal
from normalgan.plugins import REGISTRIES, is_safe, settings_of_classes
from normalgan.run_lock import one_run_in
from normalgan.warning_filters import filter_warnings

SECTIONS = ("trainer", "model", "data", "checkpoint", "pictures", "report", "output")
"""The groups of settings."""
SAFE_CONFIG = "--safe-config"
"""The option under which a configuration may name but what cannot run a program."""


INSTEAD = {
    "gradient_clip_val": "model.gradient_clip",
    "gradient_clip_algorithm": "model.gradient_clip, which is a norm",
    "accumulate_grad_batches": "a larger data.batch_size",
}
"""Settings of the trainer that do nothing under manual optimisation, and what does that instead."""


def check_trainer(settings: Mapping[str, Any]) -> None:
    """Refuse what cannot be had under manual optimisation.

    Raises:
        InputError: if such a setting was given; the sentence names the one to use.
    """
    for name, instead in INSTEAD.items():
        if settings[name] not in {None, 1 if name == "accumulate_grad_batches" else None}:
            raise InputError(f"trainer.{name} cannot be used with two optimisers; use {instead}.")


class RenderingTrainer(Trainer):
    """How and where to train: Lightning's Trainer."""

    def render(self, model: NormalGAN, datamodule: MeshDataModule, cluster: str | None = None) -> None:
        """Render the samples of every split to disk, and stop there.

        Args:
            model: not used.
            datamodule: which samples.
            cluster: a Dask cluster to render on instead of this machine: tcp://host:port, a scheduler file
                (.json), local:N, or a YAML file with class_path and init_args of a cluster class.
        """
        datamodule.render(cluster)


class SaveConfig(SaveConfigCallback):
    """Keeps the settings of training beside the run; those of a later test do not take their place."""

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Write them when training starts."""
        if stage == "fit":
            super().setup(trainer, pl_module, stage)


class NormalGANCLI(ModelLoader):
    """fit, validate, test, predict, and render."""

    held: ExitStack
    """What the command holds until it ends: the run's folder."""

    @staticmethod
    def subcommands() -> dict[str, set[str]]:
        """Return Lightning's commands and ours, with the arguments that are not options."""
        return {**LightningCLI.subcommands(), "render": {"model", "datamodule"}}

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Set the defaults, and the links that keep settings in step."""
        super().add_arguments_to_parser(parser)
        # Else 120 lines stand before any help.
        parser.usage = f"%(prog)s [--config FILE]... [{SAFE_CONFIG}] [--SETTING VALUE]..."
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
                "model.reconstruction": {"class_path": "normalgan.objectives.L1AndHints"},
                "trainer.logger": {
                    "class_path": "lightning.pytorch.loggers.TensorBoardLogger",
                    "init_args": {"save_dir": "runs", "name": "", "version": "", "default_hp_metric": False},
                },
                "trainer.plugins": {"class_path": "normalgan.checkpoints.AtomicCheckpointIO"},
                "checkpoint.monitor": "val/hints/angular_mean",
                "checkpoint.filename": "{epoch:03d}-{val/hints/angular_mean:.2f}",
                "checkpoint.auto_insert_metric_name": False,
                "checkpoint.enable_version_counter": False,
            }
        )
        parser.link_arguments(
            "trainer.default_root_dir", "trainer.logger.init_args.save_dir", compute_fn=run_folder
        )
        for name in ("generator", "discriminator", "hint_sampler", "objective"):
            action = next(action for action in parser._actions if action.dest == f"model.{name}")
            action.required = False  # it has a default here, if not in Python
        parser.link_arguments("trainer.default_root_dir", "checkpoint.dirpath", compute_fn=checkpoint_folder)
        for network in ("generator", "discriminator"):
            parser.link_arguments("data.size", f"model.{network}.init_args.size")

    def before_instantiate_classes(self) -> None:
        """Refuse to train over a finished run, or where nothing can be written."""
        super().before_instantiate_classes()
        command = self.config["subcommand"]
        config = self.config[command]
        last = Path(checkpoint_folder(config["trainer"]["default_root_dir"])) / "last.ckpt"
        check_trainer(config["trainer"])
        if command in {"predict", "render"}:
            config["trainer"]["logger"] = False  # it has nothing to log, but would leave its files
        if command == "test":
            config["verbose"] = False  # Lightning's own list of figures would bury our table
        if command in {"fit", "test"}:
            check_writable(last.parent.parent)
        if command == "fit" and config["ckpt_path"] is None:
            check_unused(last.parent)
        # The other processes of a run share its folder.
        if command == "fit" and rank_zero_only.rank == 0:  # type: ignore[attr-defined]
            self.held.enter_context(one_run_in(last.parent.parent))

    def instantiate_classes(self) -> None:
        """Build model, data and trainer; what they refuse is a setting."""
        try:
            super().instantiate_classes()
        except InputError:
            raise
        except (MisconfigurationException, ValueError, TypeError) as error:
            raise InputError(f"a setting cannot be used: {refusal(error)}") from error
        self.fill(self.model)


def run(arguments: list[str]) -> int:
    """Run one of the training commands.

    Raises:
        InputError: if something that was given cannot be used.
        KeyboardInterrupt: if it was stopped.
    """
    arguments = _check_configs(arguments)
    # One command's parser alone: each takes a fifth of a second to build.
    only = {command: skip for command, skip in NormalGANCLI.subcommands().items() if command == arguments[0]}
    with warnings.catch_warnings(), ExitStack() as held:
        cli = type("Command", (NormalGANCLI,), {"subcommands": staticmethod(lambda: only), "held": held})
        filter_warnings()
        for registry in REGISTRIES.values():
            registry.load_entry_points()
        load = get_loader("yaml")
        held.callback(set_loader, "yaml", load, (yaml.YAMLError,))
        set_loader("yaml", lambda text: load_bounded(text, load), (yaml.YAMLError,))
        try:
            cli(
                NormalGAN,
                MeshDataModule,
                save_config_callback=SaveConfig,
                save_config_kwargs={"overwrite": True},
                trainer_class=RenderingTrainer,
                trainer_defaults={"callbacks": [LastCheckpoint(), StoppedCheckpoint()]},
                seed_everything_default=0,
                parser_class=Parser,
                parser_kwargs={"prog": "normalgan", "allow_abbrev": False},
                auto_configure_optimizers=False,
                args=arguments,
            )
        except MisconfigurationException as error:
            raise InputError(shorten(brief(error), 250, placeholder=" …")) from error
        except SIGTERMException as stop:
            raise SystemExit(128 + signal.SIGTERM) from stop
        except SystemExit as stop:
            if isinstance(stop.__context__, KeyboardInterrupt):  # Lightning makes exit(1) of it
                raise stop.__context__ from None
            # --help and --print_config end like this too.
            return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    sys.stdout.flush()
    return 0


def _check_configs(arguments: list[str]) -> list[str]:
    """Look at the configurations before anything in them is used; return the parser's arguments.

    Raises:
        InputError: if one cannot be used, or is not as safe as it was asked to be.
    """
    safe = SAFE_CONFIG in arguments
    check = ConfigCheck(SECTIONS, settings_of_classes(), is_safe if safe else None)
    arguments, configs = with_shipped_configs(arguments)
    for given in configs:
        check.check(given)
    check.check_arguments(arguments)
    return [argument for argument in arguments if argument != SAFE_CONFIG]
