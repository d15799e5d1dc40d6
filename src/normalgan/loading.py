"""ModelLoader: the half of the command line that takes a model from a file."""

import sys
from abc import ABC
from pathlib import Path
from typing import Any

from lightning.pytorch.cli import LightningCLI

from normalgan.checkpoints import (
    check_size,
    check_sizes,
    checkpoint_folder,
    read_settings,
    warn_of_overruled,
)
from normalgan.errors import InputError
from normalgan.gan import NormalGAN
from normalgan.weights.file import SHIPPED, SHIPPED_NAME, SUFFIX, Weights, find_weights, read_weights


class ModelLoader(LightningCLI, ABC):
    """Lets the file that ``ckpt_path`` names decide on the model: a checkpoint or safetensors.

    ``last`` names the checkpoint in the run's folder, ``shipped`` the weights that come with the package;
    predict uses these if nothing is named.
    """

    weights: Weights | None = None
    """What the model gets, if it is not a checkpoint that Lightning loads."""

    def _parse_ckpt_path(self) -> None:
        """Let what is saved in a file decide on the model, after a look at whether it can be used."""
        command = self.config["subcommand"]
        config = self.config[command]
        given = None if command == "render" else config["ckpt_path"]
        if given is None and command in {"fit", "render"}:
            return
        if given is None and command != "predict":
            raise InputError(f"{command} needs a trained model: --ckpt_path names a file that fit saved.")
        if given == "last":
            folder = checkpoint_folder(config["trainer"]["default_root_dir"])
            config["ckpt_path"] = given = str(Path(folder) / "last.ckpt")
        path = find_weights(given or SHIPPED_NAME)
        (self._use_weights if path.suffix.lower() == SUFFIX else self._use_checkpoint)(path, command)

    def _use_checkpoint(self, path: Path, command: str) -> None:
        """Read a checkpoint's settings over the configuration's."""
        saved = read_settings(path)
        check_sizes(path, saved, self.config[command]["data"]["size"])
        self._warn_of_overruled(path, command, saved)
        try:
            super()._parse_ckpt_path()
        except InputError as error:
            raise InputError(f"the model in {path} cannot be built here: {error}") from error

    def _use_weights(self, path: Path, command: str) -> None:
        """Take the model's settings, and the size of its pictures, from safetensors."""
        if command == "fit":
            raise InputError(f"fit cannot go on from {path}, which has weights alone; give a checkpoint.")
        self.weights = read_weights(path)
        notes, size = self.weights.notes, self.config[command]["data"]["size"]
        if size != self._parser(command).get_defaults()["data"]["size"]:
            check_size(path, notes.size, size)
        saved = notes.settings()
        self._warn_of_overruled(path, command, saved)
        changes = {"model": {**saved, "discriminator": None}, "data": {"size": notes.size}, "ckpt_path": None}
        self.config = self.parser.parse_object({command: changes}, self.config)
        whose = "that come with the package" if path == SHIPPED else f"in {path}"
        print(
            f"normalgan: {command} uses the weights {whose}: {notes.generator.name}, {notes.size} pixels.",
            file=sys.stderr,
        )

    def _warn_of_overruled(self, path: Path, command: str, saved: dict[str, Any]) -> None:
        defaults = self._parser(command).get_defaults()["model"].as_dict()
        given = self.config[command]["model"].as_dict()
        warn_of_overruled(path, {k: v for k, v in given.items() if k in saved}, defaults, saved)

    def fill(self, model: NormalGAN) -> None:
        """Give the model that was built its weights, unless Lightning will load a checkpoint."""
        if self.weights is not None:
            self.weights.load_into(model.generator)
