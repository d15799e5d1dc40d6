"""The training commands: LightningCLI with our defaults, plug-ins and answers to mistakes."""

import os
import signal
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from inspect import getdoc
from pathlib import Path
from textwrap import shorten
from typing import Any

import yaml
from jsonargparse import Namespace, get_loader, set_loader, set_parsing_settings
from lightning.fabric.utilities.exceptions import MisconfigurationException
from lightning.pytorch import Trainer
from lightning.pytorch.callbacks import (
    Callback,
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
    check_size,
    check_sizes,
    check_unused,
    checkpoint_folder,
    named_checkpoint,
    run_folder,
)
from normalgan.callbacks.display import NetworkSummary, WideProgressBar
from normalgan.cli.config_files import check_config, load_bounded, with_environment
from normalgan.cli.discovery import load_plugins, safe_imports
from normalgan.cli.ignored_settings import given_names, ignored_settings
from normalgan.cli.normal_map_writer import NormalMapWriter
from normalgan.cli.number_types import Strength
from normalgan.cli.output_options import add_output_options
from normalgan.cli.parser import Parser, help_of, with_shipped_configs
from normalgan.cli.parser_errors import refusal
from normalgan.cli.trainer import RenderingTrainer, SaveConfig, check_trainer
from normalgan.cli.training_help import SECTIONS, asked_for
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError, brief
from normalgan.files.addresses import is_address
from normalgan.files.limits import load_yaml
from normalgan.files.run_lock import check_writable, one_run_in
from normalgan.gan import NormalGAN
from normalgan.inference.outputs.outputs import outputs_of
from normalgan.warning_filters import filter_warnings
from normalgan.weights.checkpoint import Checkpoint, read_checkpoint
from normalgan.weights.file import SUFFIXES, Weights, find_weights, read_weights
from normalgan.weights.local_classes import no_local_classes
from normalgan.weights.shipped import SHIPPED, SHIPPED_NAME

__all__ = [
    "SAFE_CONFIG",
    "NormalGANCLI",
    "resolved_settings",
    "run",
    "training_parser",
]

SAFE_CONFIG = "--safe-config"
"""The option under which only registered classes are imported and built."""
_OUTPUTS = (
    *("trainer.default_root_dir", "trainer.logger", "trainer.model_registry", "checkpoint.filename"),
    *("data.cache", "output.folder", "cluster"),
)
"""What writes, or runs elsewhere: `SAFE_CONFIG` takes it from the command line alone."""

_OPTIMIZER = {"class_path": "torch.optim.RMSprop", "init_args": {"lr": 5e-5, "alpha": 0.9}}
_LOADERS = {"train_dataloaders", "val_dataloaders", "dataloaders"}
"""Arguments of the Trainer's methods that are not settings, because the data module provides them."""


class NormalGANCLI(LightningCLI):
    """fit, validate, test, predict, and render.

    The file that ``ckpt_path`` names decides on the model: a checkpoint, safetensors or ONNX. ``last`` and
    ``best`` name checkpoints in the run's folder, ``shipped`` the weights that come with the package; predict
    uses these if none are named. The path is taken out of the settings before Lightning sees it, as that
    would build whatever class a checkpoint names. Only fit gets it back, after the checkpoint was checked.

    There is one parser for the command instead of Lightning's parser of subcommands, which checks each
    setting twice and so doubles the time of parsing.

    Args:
        command: the Trainer's method that is run.
        arguments: its options.
        held: resources to release when the command ends, such as the lock of the run's folder.
        safe: whether configurations may not say where the run writes.
    """

    def __init__(self, command: str, arguments: list[str], held: ExitStack, safe: bool = False) -> None:
        self.command = command
        self.held = held
        self.safe = safe
        self.measured: Path | None = None  # the file that test measures
        self.weights: Weights | None = None  # what the model gets, if it does not go on learning
        self.resumed: Path | None = None  # the checkpoint that fit goes on from
        self.checkpoint: Checkpoint | None = None  # what it holds
        self.known: set[str] = set()  # the folders that its callbacks wrote to
        self.given = given_names(*with_shipped_configs(arguments), "model")
        super().__init__(
            NormalGAN,
            MeshDataModule,
            save_config_callback=SaveConfig,
            save_config_kwargs={"overwrite": True},
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

    def run_command(self) -> None:
        """Run the command."""
        options = {name: self.config_init[name] for name in self._options}
        getattr(self.trainer, self.command)(model=self.model, datamodule=self.datamodule, **options)
        if self.command == "fit" and self.trainer.is_global_zero:
            self._print_outcome()

    def _print_outcome(self) -> None:
        """Print why training stopped early, if it did, and which checkpoint is best."""
        for stopping in self.trainer.early_stopping_callbacks:
            if isinstance(stopping, EarlyStopping) and (reason := stopping.stopping_reason_message):
                print(f"Training stopped early. {reason.removesuffix(' Signaling Trainer to stop.')}")
        for callback in self.trainer.checkpoint_callbacks:
            if isinstance(callback, ModelCheckpoint) and callback.monitor and callback.best_model_path:
                score = f"{callback.monitor} {float(callback.best_model_score or 0):.4g}"
                print(f"The best checkpoint is {callback.best_model_path} ({score}).")

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Set the defaults, and the links that keep settings in step."""
        # Else 120 lines stand before any help.
        parser.usage = f"%(prog)s [--config FILE]... [{SAFE_CONFIG}] [--SETTING VALUE]..."
        parser.add_lightning_class_args(ModelCheckpoint, "checkpoint")
        parser.add_lightning_class_args(PictureLogger, "pictures")
        parser.add_lightning_class_args(TestReport, "report")
        group = parser.add_argument_group("What predict writes for each drawing")
        group.add_argument("--output.folder", type=str, default="normals", help="where the maps go")
        group.add_argument(
            "--output.strength",
            type=Strength,
            default=1.0,
            help="what the slopes of the map are multiplied by",
        )
        add_output_options(parser, group, "output.")
        parser.set_defaults(
            {
                "model.generator": {"class_path": "normalgan.models.UNetGenerator"},
                "model.discriminator": {"class_path": "normalgan.models.UNetDiscriminator"},
                "model.hint_sampler": {"class_path": "normalgan.hints.CurvatureHints"},
                "model.objective": {"class_path": "normalgan.losses.Wasserstein"},
                "model.reconstruction": {"class_path": "normalgan.losses.L1AndHints"},
                # Named, so that an overlay or a single option can change one of their settings.
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
        not_options: set[str | int] = {"model", "datamodule", *_LOADERS}
        self._options = parser.add_method_arguments(RenderingTrainer, self.command, skip=not_options)

    def parse_arguments(self, parser: LightningArgumentParser, args: Any) -> None:
        """Take the model's settings from the file given by ``ckpt_path``, after checking it."""
        super().parse_arguments(parser, args)
        command, config = self.command, self.config
        _check_groups(parser, config)
        if self.safe:
            own = parser.parse_args(_set_here(args))
            for name in _OUTPUTS:
                if config.get(name) != own.get(name):
                    raise InputError(
                        f"a configuration sets {name}, and {SAFE_CONFIG} takes it from the command line "
                        f"alone: give --{name}."
                    )
            if own.get("ckpt_path") != (given := config.get("ckpt_path")) and is_address(str(given)):
                raise InputError(f"{SAFE_CONFIG} fetches no address that a configuration names: {given}.")
        given = None if command == "render" else config["ckpt_path"]
        if given is None and command in {"fit", "render"}:
            return
        if given is None and command != "predict":
            raise InputError(f"{command} needs a trained model: --ckpt_path names a file that fit saved.")
        if given in {"last", "best"}:
            folder = Path(checkpoint_folder(config["trainer"]["default_root_dir"]))
            given = str(named_checkpoint(folder / "last.ckpt", given))
        path = find_weights(given or SHIPPED_NAME)
        config["ckpt_path"] = None
        if path.suffix.lower() in SUFFIXES:
            self._use_weights(path, command)
        elif command == "fit":
            self._resume(path)
        else:
            self._use_checkpoint(path, command)

    def before_instantiate_classes(self) -> None:
        """Refuse to train over a finished run, or in a folder that is not writable."""
        if self.resumed is not None:
            # Tell Lightning the checkpoint that fit goes on from.
            self.config["ckpt_path"] = str(self.resumed)
            self.config["weights_only"] = True
        command, config = self.command, self.config
        last = Path(checkpoint_folder(config["trainer"]["default_root_dir"])) / "last.ckpt"
        check_trainer(config["trainer"])
        if command in {"predict", "render"}:
            config["trainer"]["logger"] = False  # it has nothing to log, but would leave its files
        if command == "test":
            config["verbose"] = False  # Lightning's own list of figures would bury our table
        if command in {"fit", "test"}:
            check_writable(last.parent.parent)
        if command == "fit":
            check_unused(last.parent, self.resumed)
        # The other processes of a run share its folder.
        if command == "fit" and rank_zero_only.rank == 0:  # type: ignore[attr-defined]
            self.held.enter_context(one_run_in(last.parent.parent))

    def instantiate_classes(self) -> None:
        """Build model, data and trainer, and report their errors as bad settings."""
        try:
            super().instantiate_classes()
        except InputError:
            raise
        except (MisconfigurationException, ValueError, TypeError) as error:
            raise InputError(f"a setting cannot be used: {refusal(error)}") from error
        if self.weights is not None:
            self.weights.load_into(self.model.generator)
        if self.checkpoint is not None:
            self.checkpoint.check_progress(self.trainer.fit_loop.state_dict())
        for callback in self.trainer.callbacks:  # type: ignore[attr-defined]  # public, not typed
            if isinstance(callback, TestReport):
                callback.checkpoint = self.measured
        if self.command == "fit":
            root = self.config["trainer"]["default_root_dir"]
            check_others(self.trainer.callbacks, root, self.resumed, self.known)  # type: ignore[attr-defined]

    def instantiate_trainer(self, **kwargs: Any) -> Trainer:
        """Build the trainer with our progress bar, our summary and the writer of predicted maps."""
        own: dict[type[Callback], type[Callback]] = {
            RichProgressBar: WideProgressBar,
            RichModelSummary: NetworkSummary,
        }
        callbacks = self.config_init["trainer"]["callbacks"]
        # A copy: the trainer adds its own to the list.
        given = list(callbacks) if isinstance(callbacks, list) else [callbacks]
        trainer = super().instantiate_trainer(**kwargs)
        used: list[Callback] = trainer.callbacks  # type: ignore[attr-defined]  # public, not typed
        for number, callback in enumerate(used):
            if type(callback) in own and not any(callback is one for one in given):
                used[number] = own[type(callback)]()
        output = self.config_init["output"].as_dict()
        used.append(NormalMapWriter(output["folder"], outputs_of(output), output["strength"]))
        return trainer

    def _resume(self, path: Path) -> None:
        """Read a checkpoint's settings over the configuration's."""
        self.checkpoint = checkpoint = read_checkpoint(path)
        saved = checkpoint.training_settings()
        check_sizes(path, saved, self.config["data"]["size"])
        self._warn_of_overruled(path, "fit", saved)
        self._set(path, {"model": saved})
        states = [state for state in checkpoint.callbacks.values() if isinstance(state, Mapping)]
        self.resumed, self.known = path, {str(state.get("dirpath")) for state in states}

    def _use_checkpoint(self, path: Path, command: str) -> None:
        """Take the generator and the hint sampler of a checkpoint."""
        size = self.config["data"]["size"]
        checkpoint = read_checkpoint(path)
        check_size(path, checkpoint.generator_size(), size)
        self._predict_with(path, command, checkpoint.weights(size))

    def _use_weights(self, path: Path, command: str) -> None:
        """Take the model's settings, and the size of its pictures, from a file of weights."""
        if command == "fit":
            raise InputError(f"fit cannot resume from {path}, which holds only weights; give a checkpoint.")
        weights = read_weights(path)
        notes, size = weights.notes, self.config["data"]["size"]
        if size != self.parser.get_default("data.size"):
            check_size(path, notes.size, size)
        self._predict_with(path, command, weights)
        whose = "that come with the package" if path == SHIPPED else f"in {path}"
        print(
            f"normalgan: {command} uses the weights {whose}: {notes.generator.name}, {notes.size} pixels.",
            file=sys.stderr,
        )

    def _predict_with(self, path: Path, command: str, weights: Weights) -> None:
        try:
            saved = weights.notes.settings(measured=command != "predict")
        except InputError as error:
            raise InputError(f"the model in {path} cannot be built here: {error}") from error
        self._warn_of_overruled(path, command, saved)
        changes = {"model": {**saved, "discriminator": None}, "data": {"size": weights.notes.size}}
        self._set(path, changes)
        self.weights, self.measured = weights, path

    def _set(self, path: Path, changes: dict[str, Any]) -> None:
        """Replace settings by those in a file, whose classes may differ from the ones here."""
        try:
            self.config = self.parser.parse_object(changes, self.config)
        except InputError as error:
            raise InputError(f"the model in {path} cannot be built here: {error}") from error

    def _warn_of_overruled(self, path: Path, command: str, saved: dict[str, Any]) -> None:
        """Warn of model settings that were given but are ignored, because the file's are used."""
        defaults = self.parser.get_defaults()["model"].as_dict()
        settings = {k: v for k, v in self.config["model"].as_dict().items() if k in saved}
        if lost := ignored_settings(settings, defaults, saved, self.given):
            names = ", ".join(f"model.{name}" for name in lost)
            warnings.warn(f"{path} was trained with other settings, which are kept: {names}.", stacklevel=2)


def run(arguments: list[str]) -> int:
    """Run one of the training commands.

    Raises:
        InputError: if an argument cannot be used.
        KeyboardInterrupt: if it was stopped.
    """
    arguments, section = asked_for(arguments)
    safe = SAFE_CONFIG in arguments
    arguments = _check_configs([argument for argument in arguments if argument != SAFE_CONFIG])
    arguments = [with_environment(each) for each in arguments]  # quoted, a shell leaves them as they are
    with _reading_settings(safe) as held:
        held.enter_context(help_of(section if section in SECTIONS else None))
        try:
            NormalGANCLI(arguments[0], arguments[1:], held, safe).run_command()
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


def resolved_settings(arguments: list[str]) -> dict[str, Any]:
    """Return all settings that ``fit`` would train with, as ``--print_config`` prints them.

    Args:
        arguments: the options of ``fit``.

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
    """Inside this context plug-ins are loaded, and YAML is limited in size and depth.

    Args:
        safe: whether to import and build only registered classes. jsonargparse checks each class or function
            that a setting names; within a process this cannot be relaxed again.
    """
    with warnings.catch_warnings(), ExitStack() as held:
        filter_warnings()
        load_plugins()
        # Lightning lets jsonargparse read any URL, data: and http: too, that stands where settings may.
        set_parsing_settings(config_read_mode_fsspec_enabled=False)
        if safe:
            held.enter_context(no_local_classes())
            set_parsing_settings(
                import_path_denylist=["*"],
                import_path_allowlist=safe_imports(),
                validate_subclass_spec_in_any=True,
                instantiate_subclass_spec_in_any=False,
            )
        load = get_loader("yaml")
        held.callback(set_loader, "yaml", load, (yaml.YAMLError,))
        set_loader("yaml", lambda text: load_bounded(text, load, safe), (yaml.YAMLError,))
        yield held


def _set_here(arguments: list[str]) -> list[str]:
    """Return the arguments that set outputs directly, not through a configuration file.

    >>> _set_here(["--trainer", "theirs.yaml", "--output.folder", "maps", "--data.cache=cache"])
    ['--output.folder=maps', '--data.cache=cache']
    """
    found = []
    for word, following in zip(arguments, [*arguments[1:], ""], strict=True):
        option, joined, value = word.partition("=")
        name = option.removeprefix("--").rstrip("+")
        if any(name == output or name.startswith(f"{output}.") for output in _OUTPUTS) and word[:2] == "--":
            value = value if joined else following
            found += [] if name.startswith("trainer.logger") and _names_file(value) else [f"{option}={value}"]
    return found


def _check_groups(parser: LightningArgumentParser, config: Namespace) -> None:
    """Refuse a single value where a group of settings belongs, which jsonargparse accepts from a file."""
    names = [action.dest for action in parser._actions]
    for group in (a.dest for a in parser._actions if a.help == "Path to a configuration file."):
        if isinstance(value := config.get(group), str | int | float | list):
            inside = next(name for name in names if name.startswith(f"{group}."))
            raise InputError(f"{group} is a group of settings, such as {inside}, not {value}.")


def _names_file(value: object) -> bool:
    """Return whether a setting, or a part of it, names a file, from which a class may be read."""
    if isinstance(value, str):
        within = load_yaml(value)
        # os.path, as a long text is not a path, of which pathlib raises an error.
        return os.path.isfile(os.path.expanduser(value)) or (within != value and _names_file(within))  # noqa: PTH111, PTH113
    parts = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return any(map(_names_file, parts))


class _ParserBuiltError(Exception):
    """Stops building a command line once its parser is there."""


class _ParserAlone(NormalGANCLI):
    """Stops before anything is parsed."""

    def parse_arguments(self, parser: LightningArgumentParser, args: Any) -> None:
        """Give the parser back."""
        raise _ParserBuiltError(parser)


def training_parser(command: str) -> Parser:
    """Return the parser of a training command, to list its settings: the site, shell completion."""
    try:
        _ParserAlone(command, [], ExitStack())
    except _ParserBuiltError as built:
        parser: Parser = built.args[0]
        return parser
    raise AssertionError("Lightning's command line did not parse")


def _check_configs(arguments: list[str]) -> list[str]:
    """Look at the configurations before anything in them is used; return the parser's arguments.

    Raises:
        InputError: if one is invalid.
    """
    arguments, configs = with_shipped_configs(arguments)
    for given in configs:
        check_config(given, SECTIONS)
    return arguments
