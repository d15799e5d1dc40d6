"""The training commands: LightningCLI with our defaults, plug-ins and error messages."""

import signal
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from inspect import getdoc
from pathlib import Path
from textwrap import shorten
from typing import Any, Self

import yaml
from jsonargparse import Namespace, get_loader, set_loader, set_parsing_settings
from lightning.fabric.utilities.exceptions import MisconfigurationException
from lightning.pytorch import Trainer
from lightning.pytorch.callbacks import (
    Callback,
    Checkpoint,
    EarlyStopping,
    ModelCheckpoint,
    RichModelSummary,
    RichProgressBar,
)
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI
from lightning.pytorch.utilities import rank_zero_only
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks import PictureLogger, StoppedCheckpoint, TestReport
from normalgan.callbacks.checkpoints import (
    LastCheckpoint,
    check_others,
    check_unused,
    checkpoint_folder,
    run_folder,
)
from normalgan.callbacks.display import NetworkSummary, WideProgressBar
from normalgan.cli.discovery import load_plugins
from normalgan.cli.parsing.config_files import (
    check_config,
    load_bounded,
    with_environment,
    with_shipped_configs,
)
from normalgan.cli.parsing.errors import refusal
from normalgan.cli.parsing.number_types import Strength
from normalgan.cli.parsing.output_options import add_output_options
from normalgan.cli.training.help import SECTIONS, asked_for
from normalgan.cli.training.normal_map_writer import NormalMapWriter
from normalgan.cli.training.parser import Parser, help_of
from normalgan.cli.training.safe_config import SAFE_CONFIG, allow_known_classes_only, check_outputs
from normalgan.cli.training.saved_model import (
    SavedModel,
    announce,
    find_saved_model,
    ignored_settings,
    read_saved_model,
)
from normalgan.cli.training.slurm import check_left_behind, requeued_on_signal, restarted_from, with_slurm
from normalgan.cli.training.trainer import (
    RenderingTrainer,
    SaveConfig,
    check_strategy,
    check_trainer,
    keep_earlier_logs,
    refused_by_lightning,
    validation_first,
)
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import CommandExit, InputError, brief, printable, tell
from normalgan.files.run_lock import check_writable, one_run_in
from normalgan.gan import NormalGAN
from normalgan.inference.outputs.output_set import outputs_of
from normalgan.warning_filters import filter_warnings
from normalgan.weights.network import naming_model

_OPTIMIZER = {"class_path": "torch.optim.RMSprop", "init_args": {"lr": 5e-5, "alpha": 0.9}}
_DEFAULTS = {
    "model.generator": {"class_path": "normalgan.models.UNetGenerator"},
    "model.discriminator": {"class_path": "normalgan.models.UNetDiscriminator"},
    "model.hint_sampler": {"class_path": "normalgan.hints.CurvatureHints"},
    "model.objective": {"class_path": "normalgan.losses.Wasserstein"},
    "model.reconstruction": {"class_path": "normalgan.losses.L1AndHints"},
    # Named explicitly, so that an overlay or an option can change a single setting of a class.
    "model.generator_optimizer": _OPTIMIZER,
    "model.discriminator_optimizer": _OPTIMIZER,
    "trainer.logger": {
        "class_path": "lightning.pytorch.loggers.TensorBoardLogger",
        "init_args": {"save_dir": "runs", "name": "", "version": "", "default_hp_metric": False},
    },
    "trainer.plugins": {"class_path": "normalgan.callbacks.checkpoints.AtomicCheckpointIO"},
    "checkpoint.monitor": "val/hints/angular_mean",
    "checkpoint.filename": "{epoch:03d}-{val/hints/angular_mean:.2f}",
    "checkpoint.auto_insert_metric_name": False,
    "checkpoint.enable_version_counter": False,
}


class NormalGANCLI(LightningCLI):
    """Runs one of the commands fit, validate, test, predict and render.

    The file that ``ckpt_path`` names determines the model: a checkpoint, safetensors or ONNX. ``last`` and
    ``best`` name checkpoints in the run's folder, and ``shipped`` names the shipped weights, which are the
    default of predict. The path is removed from the settings before Lightning sees it, because Lightning
    would build any class that a checkpoint names. Only fit gets it back, after the checkpoint has been
    checked.

    Each command has a parser of its own instead of Lightning's subcommands, which check each setting twice
    and double the parsing time.

    Args:
        command: method of the Trainer that is run.
        arguments: arguments of the command.
        held: resources to release when the command ends, such as the lock of the run's folder.
        safe: whether configurations are restricted as with ``--safe-config``.
    """

    def __init__(self, command: str, arguments: list[str], held: ExitStack, safe: bool = False) -> None:
        self.command = command
        self.held = held
        self.safe = safe
        self.saved: SavedModel | None = None  # None if the command creates a new model or needs none
        super().__init__(
            NormalGAN,
            MeshDataModule,
            save_config_callback=SaveConfig,
            save_config_kwargs={"save_to_log_dir": False},
            trainer_class=RenderingTrainer,
            trainer_defaults={"callbacks": [LastCheckpoint(), StoppedCheckpoint()]},
            seed_everything_default=0,
            parser_class=Parser,
            parser_kwargs={
                "prog": f"normalgan {command}",
                "description": str(getdoc(getattr(RenderingTrainer, command))).partition("\n\n")[0],
                "allow_abbrev": False,
            },
            auto_configure_optimizers=False,
            args=arguments,
            run=False,
        )

    def __deepcopy__(self, memo: object) -> Self:
        """Return the command itself.

        Callbacks that average weights copy the model. Its optimizer factories, which jsonargparse creates,
        refer to the command, and so to the trainer, the data and the run's lock.
        """
        return self

    def run_command(self) -> None:
        """Run the command."""
        options = {name: self.config_init[name] for name in self._options}
        if self.trainer.limit_val_batches == 0:  # the end of the run says it, without a hint on how to log
            warnings.filterwarnings("ignore", message=".*could not find the monitored key")
        getattr(self.trainer, self.command)(model=self.model, datamodule=self.datamodule, **options)
        if self.command == "fit" and self.trainer.is_global_zero:
            self._print_outcome()

    def _print_outcome(self) -> None:
        """Print why nothing was trained or training stopped early, if applicable, and the best checkpoint."""
        resumed = self.saved.checkpoint if self.saved else None
        progress = resumed.progress if resumed else {"global_step": 0, "epoch": -1}
        trained, most = progress["epoch"] + 1, self.trainer.max_epochs
        if self.trainer.global_step == progress["global_step"]:
            if resumed and most is not None and -1 < most <= trained:
                print(
                    f"Nothing was left to train: {printable(resumed.path)} is from epoch {trained}, and "
                    f"--trainer.max_epochs is {most}; pass a larger one to train on."
                )
            else:
                print("Nothing was trained: the run ended before its first step.")
        for stopping in self.trainer.early_stopping_callbacks:
            if isinstance(stopping, EarlyStopping) and (reason := stopping.stopping_reason_message):
                print(f"Training stopped early. {reason.removesuffix(' Signaling Trainer to stop.')}")
        for callback in self.trainer.checkpoint_callbacks:
            if not isinstance(callback, ModelCheckpoint) or not callback.monitor or not callback.save_top_k:
                continue
            if callback.best_model_path:
                best = callback.best_model_score  # None if a resumed run did not train any further
                score = "" if best is None else f" ({callback.monitor} {float(best):.4g})"
                print(printable(f"The best checkpoint is {callback.best_model_path}{score}."))
            elif self.trainer.global_step > progress["global_step"]:
                validated = any(name.startswith("val/") for name in self.trainer.callback_metrics)
                why = f"no epoch measured {callback.monitor}" if validated else "no epoch was validated"
                last = Path(checkpoint_folder(self.config["trainer"]["default_root_dir"])) / "last.ckpt"
                print(printable(f"No checkpoint is the best, because {why}; the last one is {last}."))

    @property
    def stopped(self) -> str:
        """The message after Ctrl-C, which says how to resume if there is a checkpoint."""
        last = Path(checkpoint_folder(self.config["trainer"]["default_root_dir"])) / "last.ckpt"
        return f"stopped; resume with --ckpt_path {last}." if self.command == "fit" and last.exists() else ""

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Add our settings and the command's options."""
        # The default usage text would put 120 lines before the help.
        parser.usage = f"%(prog)s [--config FILE]... [{SAFE_CONFIG}] [--SETTING VALUE]..."
        _add_settings(parser)
        # Values that the data module provides are not options.
        provided: set[str | int] = {"train_dataloaders", "val_dataloaders", "dataloaders"}
        skip = {"model", "datamodule", *provided}
        self._options = parser.add_method_arguments(RenderingTrainer, self.command, skip=skip)

    def parse_arguments(self, parser: LightningArgumentParser, args: Any) -> None:
        """Parse the arguments, and take the model's settings from the file that ``ckpt_path`` names."""
        super().parse_arguments(parser, args)
        _check_groups(parser, self.config)
        seed = self.config["seed_everything"]
        if not 0 <= seed < 2**32:
            raise InputError(f"seed_everything is {seed}; it must be from 0 to {2**32 - 1}.")
        if self.safe:
            check_outputs(parser, args, self.config)
        name, root = self.config.get("ckpt_path"), self.config["trainer"]["default_root_dir"]
        if self.command == "fit" and name is None and (saved := restarted_from(root)):
            name = str(saved)
            if rank_zero_only.rank == 0:  # type: ignore[attr-defined]
                tell(f"SLURM has started this job again; fit resumes {name}.")
        path = find_saved_model(self.command, name, root)
        if path is not None:
            self.config["ckpt_path"] = None
            size, default = self.config["data"]["size"], parser.get_default("data.size")
            self.saved = read_saved_model(path, self.command, size, default)
            # Other settings are derived from these two, so they must be present.
            linked = ["--trainer.default_root_dir=.", f"--data.size={size}"]
            given = parser.parse_args([*linked, *args], defaults=False)
            self._use_settings_of(self.saved, given.as_dict().get("model", {}))
            announce(self.saved, self.command)

    def before_instantiate_classes(self) -> None:
        """Refuse to train over a finished run, or in a folder that is not writable."""
        command, config = self.command, self.config
        resumed = self.saved.path if self.saved and command == "fit" else None
        if resumed is not None:
            config["ckpt_path"] = str(resumed)
            config["weights_only"] = True
        checkpoints = Path(checkpoint_folder(config["trainer"]["default_root_dir"]))
        check_trainer(config["trainer"], command)
        check_left_behind(config["trainer"]["default_root_dir"])
        keep_earlier_logs(config["trainer"])
        if command in {"predict", "render"}:
            config["trainer"]["logger"] = False  # it would create files, but nothing is logged
        if command == "test":
            config["verbose"] = False  # Lightning's own list of metrics would bury our table
        if command in {"fit", "test"}:
            check_writable(checkpoints.parent)
        if command == "fit":
            check_unused(checkpoints, resumed)
            # The other processes of a run share its folder.
            if rank_zero_only.rank == 0:  # type: ignore[attr-defined]
                self.held.enter_context(one_run_in(checkpoints.parent))

    def instantiate_classes(self) -> None:
        """Build model, data and trainer, and report their errors as errors in the settings."""
        try:
            super().instantiate_classes()
        except InputError:
            raise
        except (MisconfigurationException, ValueError, TypeError) as error:
            raise InputError(f"a setting cannot be used: {refusal(error)}") from error
        saved, callbacks = self.saved, self.trainer.callbacks  # type: ignore[attr-defined]  # public, not typed
        if saved and saved.weights:
            saved.weights.load_into(self.model.generator)
            for callback in callbacks:
                if isinstance(callback, TestReport):
                    callback.checkpoint = saved.path
        if saved and saved.checkpoint:
            saved.checkpoint.check_progress(self.trainer.fit_loop.state_dict())
            epoch, most = saved.checkpoint.progress["epoch"], self.trainer.max_epochs
            if most is not None and -1 < most < epoch:
                raise InputError(
                    f"{saved.path} is from epoch {epoch + 1}, but --trainer.max_epochs is {most}; "
                    "pass a larger one to train on."
                )
        if self.command == "fit":
            if self.model.discriminator is not None:
                check_strategy(self.trainer, self.config["trainer"]["strategy"])
            root = self.config["trainer"]["default_root_dir"]
            resumed, known = (saved.path, saved.folders) if saved else (None, set())
            check_others(callbacks, root, resumed, known)

    def instantiate_trainer(self, **kwargs: Any) -> Trainer:
        """Build the trainer with our progress bar, model summary and writer of predicted maps."""
        own: dict[type[Callback], type[Callback]] = {
            RichProgressBar: WideProgressBar,
            RichModelSummary: NetworkSummary,
        }
        callbacks = self.config_init["trainer"]["callbacks"]
        # A copy, because the trainer adds its own callbacks to the list.
        given = list(callbacks) if isinstance(callbacks, list) else [callbacks]
        plugins = self.config_init["trainer"]["plugins"] or []
        plugins = with_slurm(plugins if isinstance(plugins, list) else [plugins])
        saves = self.config_init["trainer"]["enable_checkpointing"] is not False
        if not saves:
            if others := [type(each).__name__ for each in given if isinstance(each, Checkpoint)]:
                raise InputError(
                    f"trainer.enable_checkpointing is false, but trainer.callbacks names {others[0]}, which "
                    "saves checkpoints; remove one of the two."
                )
            kwargs["enable_checkpointing"] = True  # Lightning refuses our callbacks otherwise
        trainer = super().instantiate_trainer(plugins=plugins, **kwargs)
        used: list[Callback] = trainer.callbacks  # type: ignore[attr-defined]  # public, not typed
        if not saves:
            used[:] = [each for each in used if not isinstance(each, (Checkpoint, StoppedCheckpoint))]
        for number, callback in enumerate(used):
            if type(callback) in own and not any(callback is one for one in given):
                used[number] = own[type(callback)]()
        output = self.config_init["output"].as_dict()
        used.append(NormalMapWriter(output["folder"], outputs_of(output), output["strength"]))
        return trainer

    def _use_settings_of(self, saved: SavedModel, given: Mapping[str, Any]) -> None:
        """Replace settings with those of a saved model, and warn about given settings that are ignored."""
        if lost := ignored_settings(given, saved.trained):
            names = ", ".join(f"model.{name}" for name in lost)
            warnings.warn(
                f"{saved.path} was trained with other settings, which are kept: {names}.", stacklevel=2
            )
        with naming_model(saved.path):
            # Parsed again, because the saved classes may differ from the given ones.
            self.config = self.parser.parse_object(saved.settings, self.config)


def run(arguments: list[str]) -> int:
    """Run one of the training commands.

    Raises:
        InputError: if an argument is invalid.
        KeyboardInterrupt: if the command was stopped.
    """
    arguments, section = asked_for(arguments)
    safe = SAFE_CONFIG in arguments
    arguments = _check_configs([argument for argument in arguments if argument != SAFE_CONFIG])
    arguments = [
        with_environment(each) for each in arguments
    ]  # a shell does not expand variables in single quotes
    ctrl_c = signal.getsignal(signal.SIGINT)
    with _reading_settings(safe) as held:
        held.enter_context(help_of(section if section in SECTIONS else None))
        held.enter_context(requeued_on_signal())
        command: NormalGANCLI | None = None
        try:
            command = NormalGANCLI(arguments[0], arguments[1:], held, safe)
            command.run_command()
        except MisconfigurationException as error:
            raise InputError(shorten(brief(error), 250, placeholder=" …")) from error
        except (ValueError, RuntimeError) as error:
            if isinstance(error, InputError) or not refused_by_lightning(error):
                raise
            reason = shorten(validation_first(brief(error)), 250, placeholder=" …")
            raise InputError(f"a setting cannot be used: {reason}") from error
        except SIGTERMException:
            return 128 + signal.SIGTERM
        except CommandExit as stop:
            return int(stop.code or 0)
        except SystemExit as stop:
            if isinstance(stop.__context__, KeyboardInterrupt):
                # Lightning turns it into exit(1), and may leave Ctrl-C ignored in this process.
                signal.signal(signal.SIGINT, ctrl_c)
                raise KeyboardInterrupt(command.stopped if command else "") from None
            raise
    sys.stdout.flush()
    return 0


def resolved_settings(arguments: list[str]) -> dict[str, Any]:
    """Return all settings that ``fit`` would train with, as ``--print_config`` prints them.

    Args:
        arguments: arguments of ``fit``.

    Raises:
        InputError: if ``fit`` would refuse them.
    """
    arguments = _check_configs(["fit", *arguments])
    with _reading_settings():
        parser = training_parser("fit")
        settings: dict[str, Any] = yaml.safe_load(
            parser.dump(parser.parse_args(arguments[1:]), skip_unset=False)
        )
    return settings


@contextmanager
def _reading_settings(safe: bool = False) -> Iterator[ExitStack]:
    """Load plug-ins, and limit the size and depth of YAML within the context.

    Args:
        safe: whether only known classes may be imported and built.
    """
    with warnings.catch_warnings(), ExitStack() as held:
        filter_warnings()
        load_plugins()
        # Lightning lets jsonargparse read settings from any URL, even data: and http:.
        set_parsing_settings(config_read_mode_fsspec_enabled=False)
        if safe:
            allow_known_classes_only(held)
        load = get_loader("yaml")
        held.callback(set_loader, "yaml", load, (yaml.YAMLError,))
        set_loader("yaml", lambda text: load_bounded(text, load, safe), (yaml.YAMLError,))
        yield held


def _check_groups(parser: LightningArgumentParser, config: Namespace) -> None:
    """Raise `InputError` if a group of settings is a single value, which jsonargparse accepts from a file."""
    names = [action.dest for action in parser._actions]
    for group in (a.dest for a in parser._actions if a.help == "Path to a configuration file."):
        if isinstance(value := config.get(group), str | int | float | list):
            inside = next(name for name in names if name.startswith(f"{group}."))
            raise InputError(f"{group} is a group of settings, such as {inside}, not {value}.")


def _add_settings(parser: LightningArgumentParser) -> None:
    """Add our settings and defaults to a parser that has those of model, data and trainer.

    Output folders are derived from the run's folder, and the size of the networks from the size of the
    pictures.
    """
    parser.add_lightning_class_args(ModelCheckpoint, "checkpoint")
    parser.add_lightning_class_args(PictureLogger, "pictures")
    parser.add_lightning_class_args(TestReport, "report")
    group = parser.add_argument_group("What predict writes for each drawing")
    group.add_argument("--output.folder", type=str, default="normals", help="output folder of the maps")
    group.add_argument(
        "--output.strength", type=Strength, default=1.0, help="factor applied to the slopes of the map"
    )
    add_output_options(group, "output.")
    parser.set_defaults(_DEFAULTS)
    for action in parser._actions:
        if action.dest in _DEFAULTS:
            action.required = False  # it has a default on the command line, though not in Python
    root = "trainer.default_root_dir"
    parser.link_arguments(root, "trainer.logger.init_args.save_dir", compute_fn=run_folder)
    parser.link_arguments(root, "checkpoint.dirpath", compute_fn=checkpoint_folder)
    for network in ("generator", "discriminator"):
        parser.link_arguments("data.size", f"model.{network}.init_args.size")


class _ParserBuiltError(Exception):
    """Raised to stop building a command line once its parser exists."""


class _ParserAlone(NormalGANCLI):
    """A command line that stops before anything is parsed."""

    def parse_arguments(self, parser: LightningArgumentParser, args: Any) -> None:
        """Raise the exception that carries the parser."""
        raise _ParserBuiltError(parser)


def training_parser(command: str) -> Parser:
    """Return the parser of a training command, for tools that list its settings."""
    try:
        _ParserAlone(command, [], ExitStack())
    except _ParserBuiltError as built:
        parser: Parser = built.args[0]
        return parser
    raise AssertionError("Lightning's command line did not parse")


def _check_configs(arguments: list[str]) -> list[str]:
    """Check the configurations before anything in them is used; return the normalised arguments.

    Raises:
        InputError: if a configuration is invalid.
    """
    arguments, configs = with_shipped_configs(arguments)
    for given in configs:
        check_config(given, SECTIONS)
    return arguments
