"""ModelLoader: the half of the command line that takes a model from a file."""

import sys
from abc import ABC
from pathlib import Path
from typing import Any

from lightning.pytorch.cli import LightningArgumentParser, LightningCLI

from normalgan.checkpoints import (
    check_size,
    check_sizes,
    checkpoint_folder,
    named_checkpoint,
    warn_of_overruled,
)
from normalgan.errors import InputError
from normalgan.gan import NormalGAN
from normalgan.weights.checkpoint import read_checkpoint
from normalgan.weights.file import SHIPPED, SHIPPED_NAME, SUFFIX, Weights, find_weights, read_weights


class ModelLoader(LightningCLI, ABC):
    """Lets the file that ``ckpt_path`` names decide on the model: a checkpoint or safetensors.

    ``last`` and ``best`` name checkpoints in the run's folder, ``shipped`` the weights that come with the
    package; predict uses these if nothing is named.

    The path is taken out of the settings before Lightning sees it, which would build from a checkpoint
    whatever class it names. Only fit gets it back, once the checkpoint was looked at.
    """

    weights: Weights | None = None
    """What the model gets, if it does not go on learning."""
    resumed: str | None = None
    """The checkpoint that fit goes on from."""
    options: LightningArgumentParser
    """The parser of the command."""

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Keep the command's parser, for its defaults."""
        self.options = parser

    def parse_arguments(self, parser: LightningArgumentParser, args: Any) -> None:
        """Let what is saved in a file decide on the model, after a look at whether it can be used."""
        super().parse_arguments(parser, args)
        command = self.config["subcommand"]
        config = self.config[command]
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
        if path.suffix.lower() == SUFFIX:
            self._use_weights(path, command)
        elif command == "fit":
            self._resume(path)
        else:
            self._use_checkpoint(path, command)

    def before_instantiate_classes(self) -> None:
        """Tell Lightning the checkpoint that fit goes on from."""
        if self.resumed is not None:
            self.config["fit"]["ckpt_path"] = self.resumed
            self.config["fit"]["weights_only"] = True

    def _resume(self, path: Path) -> None:
        """Read a checkpoint's settings over the configuration's."""
        checkpoint = read_checkpoint(path)
        saved = checkpoint.training_settings()
        check_sizes(path, saved, self.config["fit"]["data"]["size"])
        self._warn_of_overruled(path, "fit", saved)
        try:
            self.config = self.parser.parse_object({"fit": {"model": saved}}, self.config)
        except InputError as error:
            raise InputError(f"the model in {path} cannot be built here: {error}") from error
        self.resumed = str(path)

    def _use_checkpoint(self, path: Path, command: str) -> None:
        """Take the generator of a checkpoint and the hints it learnt with; what else learnt is left alone."""
        size = self.config[command]["data"]["size"]
        checkpoint = read_checkpoint(path)
        check_size(path, checkpoint.generator_size(), size)
        self._paint_with(path, command, checkpoint.weights(size))

    def _use_weights(self, path: Path, command: str) -> None:
        """Take the model's settings, and the size of its pictures, from safetensors."""
        if command == "fit":
            raise InputError(f"fit cannot go on from {path}, which has weights alone; give a checkpoint.")
        weights = read_weights(path)
        notes, size = weights.notes, self.config[command]["data"]["size"]
        if size != self.options.get_defaults()["data"]["size"]:
            check_size(path, notes.size, size)
        self._paint_with(path, command, weights)
        whose = "that come with the package" if path == SHIPPED else f"in {path}"
        print(
            f"normalgan: {command} uses the weights {whose}: {notes.generator.name}, {notes.size} pixels.",
            file=sys.stderr,
        )

    def _paint_with(self, path: Path, command: str, weights: Weights) -> None:
        saved = weights.notes.settings()
        self._warn_of_overruled(path, command, saved)
        changes = {"model": {**saved, "discriminator": None}, "data": {"size": weights.notes.size}}
        self.config = self.parser.parse_object({command: changes}, self.config)
        self.weights = weights

    def _warn_of_overruled(self, path: Path, command: str, saved: dict[str, Any]) -> None:
        defaults = self.options.get_defaults()["model"].as_dict()
        given = self.config[command]["model"].as_dict()
        warn_of_overruled(path, {k: v for k, v in given.items() if k in saved}, defaults, saved)

    def fill(self, model: NormalGAN) -> None:
        """Give the model that was built its weights, unless Lightning will load them."""
        if self.weights is not None:
            self.weights.load_into(model.generator)
