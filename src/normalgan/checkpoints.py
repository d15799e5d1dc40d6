"""Checkpoints: written whole or not at all, and looked at before they are used."""

import importlib
import inspect
import os
import warnings
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import torch
from lightning.fabric.plugins import TorchCheckpointIO
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import ModelCheckpoint

from normalgan.errors import InputError
from normalgan.normals import write_bytes
from normalgan.torch_files import load_torch_file


class LastCheckpoint(ModelCheckpoint):
    """Keeps ``last.ckpt`` in step with training, so that a run that was killed loses part of an epoch only.

    Lightning's own ``save_last`` saves only together with a new best (since 2.6), and before the epoch has
    ended where not every epoch is validated, so that resuming goes wrong.
    """

    def __init__(self) -> None:
        super().__init__(filename="last", save_on_train_epoch_end=True, enable_version_counter=False)

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Take the folder of the run."""
        self.dirpath = checkpoint_folder(trainer.default_root_dir)
        super().setup(trainer, pl_module, stage)


class AtomicCheckpointIO(TorchCheckpointIO):
    """Writes a checkpoint beside its place and renames it, so that a kill never leaves a part of one.

    Lightning writes to the system's folder of temporary files, and from another disk a file is not renamed
    but copied over the last checkpoint.
    """

    def save_checkpoint(
        self, checkpoint: dict[str, Any], path: str | Path, storage_options: Any | None = None
    ) -> None:
        """Save a checkpoint as a file or under a URL."""
        if "://" in str(path):  # object stores show an object once it is complete
            super().save_checkpoint(checkpoint, path, storage_options)
            return
        # What a killed run left half written; one process writes to a run's folder.
        for left in Path(path).parent.glob(".*.ckpt.*.tmp"):
            left.unlink(missing_ok=True)
        # In memory first: torch tells a full disk from a bug in it only by chance.
        buffer = BytesIO()
        torch.save(checkpoint, buffer)
        write_bytes(path, buffer.getbuffer())

    def remove_checkpoint(self, path: str | Path) -> None:
        """Remove a checkpoint that a better one replaces: a file, and never all that is under a folder."""
        if "://" in str(path):
            super().remove_checkpoint(path)
        else:
            Path(path).unlink(missing_ok=True)


def run_folder(root: str | None) -> str:
    """Return the folder of a run: ``trainer.default_root_dir``, or the working directory without it."""
    return root or "."


def checkpoint_folder(root: str | None) -> str:
    """Return where the checkpoints of a run go, by the run's folder."""
    return str(Path(run_folder(root)) / "checkpoints")


def stopped_checkpoint(root: str | None) -> Path:
    """Return where a run that is stopped within an epoch leaves its checkpoint, by the run's folder."""
    return Path(checkpoint_folder(root)) / "stopped.ckpt"


def best_checkpoint(last: Path) -> Path | None:
    """Return the checkpoint of a run that was best on the validation split; None if none was measured.

    Args:
        last: ``last.ckpt`` of the run, which knows it; the run's folder may have been moved since. The age of
            files tells nothing: a run that was stopped and resumed leaves ``stopped.ckpt`` behind.

    Raises:
        InputError: if it cannot be read, or the best checkpoint is gone.
    """
    content = load_torch_file(last)
    callbacks = content.get("callbacks") if isinstance(content, dict) else None
    states = callbacks.values() if isinstance(callbacks, dict) else []
    monitoring = [state for state in states if isinstance(state, dict) and state.get("monitor")]
    paths = [
        path
        for path in (state.get("best_model_path") for state in monitoring)
        if path and isinstance(path, str)
    ]
    if not paths:
        return None
    best = last.with_name(Path(paths[0]).name)
    if not best.is_file():
        raise InputError(f"{best}, the best checkpoint of its run, is gone.")
    return best


def named_checkpoint(last: Path, name: str) -> Path:
    """Return the checkpoint that ``last`` or ``best`` names.

    Args:
        last: ``last.ckpt`` of the run.
        name: which one.

    Raises:
        InputError: if none is the best.
    """
    if name == "last":
        return last
    best = best_checkpoint(last)
    if best is None:
        raise InputError(f"no epoch of the run of {last} was validated, so that none is its best.")
    return best


def check_unused(folder: Path) -> None:
    """Make sure that the folder of a new run's checkpoints holds none to go on from.

    Raises:
        InputError: if it does.
    """
    for there in (folder / "last.ckpt", stopped_checkpoint(str(folder.parent))):
        if there.is_file():
            raise InputError(
                f"{folder} holds a run already: resume it with --ckpt_path {there}, "
                "or give another --trainer.default_root_dir."
            )


def check_sizes(path: Path, settings: Mapping[str, Any], size: int) -> None:
    """Compare the sizes of the networks' pictures with that of the data; see `check_size`."""
    for network in ("generator", "discriminator"):
        check_size(path, ((settings.get(network) or {}).get("init_args") or {}).get("size"), size)


def check_size(path: Path, trained: int | None, size: int) -> None:
    """Compare the size that a model was trained at, None for any, with that of the data.

    Raises:
        InputError: if they differ.
    """
    if trained not in {None, size}:
        raise InputError(f"{path} was trained at {trained} pixels, not {size}; give --data.size {trained}.")


def check_writable(folder: Path) -> None:
    """Make sure that a folder can be made and written to, and make none.

    Raises:
        InputError: if it cannot.
    """
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise InputError(f"the run cannot be kept in {folder}: {there} is no folder.")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"the run cannot be kept in {folder}: {there} may not be written to.")


def warn_of_overruled(
    path: Path, given: Mapping[str, Any], defaults: Mapping[str, Any], saved: Mapping[str, Any]
) -> None:
    """Warn of settings of the model that were given, while those in the file are used.

    Args:
        path: of the file.
        given: as `overruled` takes it, as are the next two.
        defaults: of the same settings.
        saved: in the file.
    """
    if lost := overruled(given, defaults, saved):
        names = ", ".join(f"model.{name}" for name in lost)
        warnings.warn(f"{path} was trained with other settings, and they stay: {names}.", stacklevel=3)


def overruled(given: Mapping[str, Any], defaults: Mapping[str, Any], saved: Mapping[str, Any]) -> list[str]:
    """Return the settings that were set to something else than their default and than a checkpoint says.

    Args:
        given: the settings of the model as parsed, nested.
        defaults: its settings if none are given; those of classes are looked up in their signatures.
        saved: the settings in the checkpoint.

    >>> overruled({"n_critic": 3, "seed": 0}, {"n_critic": 5, "seed": 0}, {"n_critic": 5, "seed": 1})
    ['n_critic']
    """
    names: list[str] = []
    for name, value in given.items():
        default, before = defaults.get(name), saved.get(name)
        if _plain(value) == _plain(before):
            continue
        if not isinstance(value, Mapping) or "class_path" not in value:
            names += [name] if _plain(value) != _plain(default) else []
        elif not isinstance(before, Mapping) or not _same_class(value, before):
            names += [name] if not isinstance(default, Mapping) or not _same_class(value, default) else []
        else:
            arguments = value.get("init_args") or {}
            inner = overruled(arguments, _signature(value["class_path"]), before.get("init_args") or {})
            names += [f"{name}.{argument}" for argument in inner]
    return names


def _same_class(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    """Compare by package and name: a package shows a class in other places than where it is defined."""
    one, other = str(a.get("class_path")), str(b.get("class_path"))
    return one.rpartition(".")[2] == other.rpartition(".")[2] and (
        one.partition(".")[0] == other.partition(".")[0]
    )


def _plain(value: Any) -> Any:
    """Return tuples as the lists that YAML makes of them."""
    return list(value) if isinstance(value, tuple) else value


def _signature(class_path: str) -> dict[str, Any]:
    module, _, name = class_path.rpartition(".")
    parameters = inspect.signature(getattr(importlib.import_module(module), name)).parameters.values()
    return {p.name: p.default for p in parameters}
