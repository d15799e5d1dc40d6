"""SavedModel: the model in the file that ``--ckpt_path`` names, with its training settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from normalgan.callbacks.checkpoints import check_size, checkpoint_folder, named_checkpoint
from normalgan.errors import InputError, tell
from normalgan.weights.checkpoint import Checkpoint, read_checkpoint
from normalgan.weights.file import SUFFIXES, Weights, read_weights
from normalgan.weights.network import naming_model
from normalgan.weights.shipped import SHIPPED, SHIPPED_NAME, find_model


@dataclass(frozen=True)
class SavedModel:
    """A model read from a file.

    Args:
        path: path of the file.
        trained: the model's settings during training.
        checkpoint: checkpoint that fit resumes; None for other commands.
        weights: weights that other commands load into the generator.
    """

    path: Path
    trained: dict[str, Any]
    checkpoint: Checkpoint | None = None
    weights: Weights | None = None

    @property
    def settings(self) -> dict[str, Any]:
        """The settings, by section, that replace the command's."""
        if self.weights is None:
            return {"model": self.trained}
        return {"model": {**self.trained, "discriminator": None}, "data": {"size": self.weights.notes.size}}

    @property
    def folders(self) -> set[str]:
        """The folders that callbacks of the checkpointed run wrote to."""
        callbacks = self.checkpoint.callbacks.values() if self.checkpoint else ()
        return {str(state.get("dirpath")) for state in callbacks if isinstance(state, Mapping)}


def announce(model: SavedModel, command: str) -> None:
    """Print which weights a command uses, unless they come from a given checkpoint."""
    if model.weights is not None and model.path.suffix.lower() in SUFFIXES:
        whose = "that come with the package" if model.path == SHIPPED else f"in {model.path}"
        notes = model.weights.notes
        tell(f"{command} uses the weights {whose}: {notes.generator.name}, {notes.size} pixels.")


def find_saved_model(command: str, name: str | None, root: str | None) -> Path | None:
    """Return the path of the model that a command uses; None if it does not need a model.

    Args:
        command: name of the training command.
        name: value of ``--ckpt_path``: a file, ``last``, ``best`` or ``shipped``; or None.
        root: folder of the run.

    Raises:
        InputError: if the file does not exist, or the command needs a model and none was named.
    """
    if name is None and command in {"fit", "render"}:
        return None
    if name is None and command != "predict":
        raise InputError(f"{command} needs a trained model; pass --ckpt_path with a file that fit saved.")
    if name in {"last", "best"}:
        name = str(named_checkpoint(Path(checkpoint_folder(root)) / "last.ckpt", name))
    return find_model(name, names=("last", "best", SHIPPED_NAME))


def read_saved_model(path: Path, command: str, size: int, default_size: int) -> SavedModel:
    """Return the model in a file.

    Args:
        path: path of a checkpoint, or of weights.
        command: name of the training command.
        size: side of the pictures in pixels; must be the model's, unless it is the default.
        default_size: default side of the pictures.

    Raises:
        InputError: if the file is invalid.
    """
    if path.suffix.lower() in SUFFIXES:
        if command == "fit":
            raise InputError(f"fit cannot resume from {path}, which holds only weights; give a checkpoint.")
        weights = read_weights(path)
        if size != default_size:
            check_size(path, weights.notes.size, size)
        return _to_predict(path, command, weights)
    checkpoint = read_checkpoint(path)
    if command == "fit":
        trained = checkpoint.training_settings()
        for network in ("generator", "discriminator"):
            check_size(path, ((trained.get(network) or {}).get("init_args") or {}).get("size"), size)
        return SavedModel(path, trained, checkpoint=checkpoint)
    if size == default_size:
        return _to_predict(path, command, checkpoint.weights(checkpoint.trained_size() or size))
    check_size(path, checkpoint.generator_size(), size)
    return _to_predict(path, command, checkpoint.weights(size))


def _to_predict(path: Path, command: str, weights: Weights) -> SavedModel:
    with naming_model(path):
        trained = weights.notes.settings(measured=command != "predict")
    return SavedModel(path, trained, weights=weights)


def ignored_settings(given: Mapping[str, Any], trained: Mapping[str, Any]) -> list[str]:
    """Return the dotted names of given settings that differ from the settings of a model's training.

    Args:
        given: model settings given to the command, nested.
        trained: settings of the model's training, nested.

    >>> ignored_settings({"n_critic": 5, "seed": 0}, {"n_critic": 5, "seed": 1})
    ['seed']
    """
    names: list[str] = []
    for name in sorted(given.keys() & trained.keys()):
        value, before = given[name], trained[name]
        if isinstance(value, Mapping) and isinstance(before, Mapping) and _same_class(value, before):
            of_class = ignored_settings(value.get("init_args") or {}, before.get("init_args") or {})
            names += [f"{name}.{argument}" for argument in of_class]
        elif _as_yaml(value) != _as_yaml(before):
            names.append(name)
    return names


def _same_class(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    """Compare classes by package and name, because a package may export a class from several modules."""
    one, other = (str(spec.get("class_path")).split(".") for spec in (a, b))
    return (one[0], one[-1]) == (other[0], other[-1])


def _as_yaml(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
