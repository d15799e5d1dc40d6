"""Checkpoints: atomic writing, and checks before use."""

import re
from collections.abc import Iterable
from io import BytesIO
from pathlib import Path
from typing import Any

import torch
from lightning.fabric.plugins import TorchCheckpointIO
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import ModelCheckpoint

from normalgan.errors import InputError
from normalgan.files.torch_files import load_torch_file
from normalgan.files.writing import write_bytes


class LastCheckpoint(ModelCheckpoint):
    """Saves ``last.ckpt`` after every epoch, so that a killed run loses at most one epoch.

    If ``max_steps`` or ``max_time`` stops a run within an epoch, the checkpoint is saved after the last
    batch. Saved any later, it would count the epoch as complete.

    Since Lightning 2.6, its own ``save_last`` saves only together with a new best checkpoint. In an epoch
    without validation, it saves before the end of the epoch, so resuming goes wrong.
    """

    def __init__(self) -> None:
        super().__init__(filename="last", save_on_train_epoch_end=True, enable_version_counter=False)

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Set the checkpoint folder of the run."""
        self.dirpath = checkpoint_folder(trainer.default_root_dir)
        super().setup(trainer, pl_module, stage)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Any, batch_idx: int
    ) -> None:
        """Save if the run stops within an epoch after this batch."""
        loop = trainer.fit_loop.epoch_loop
        if loop.done and not loop.batch_progress.is_last_batch:
            super().on_train_epoch_end(trainer, pl_module)

    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Save if the whole epoch was trained."""
        if trainer.fit_loop.epoch_loop.batch_progress.is_last_batch:
            super().on_train_epoch_end(trainer, pl_module)


class AtomicCheckpointIO(TorchCheckpointIO):
    """Writes a checkpoint next to its target and renames it, so a killed run never leaves a partial file.

    Lightning writes to the system's temporary folder instead. If that is on another disk, the file is
    copied, not renamed, over the last checkpoint.
    """

    def save_checkpoint(
        self, checkpoint: dict[str, Any], path: str | Path, storage_options: Any | None = None
    ) -> None:
        """Save a checkpoint to a file or a URL."""
        if "://" in str(path):  # object stores expose only complete objects
            super().save_checkpoint(checkpoint, path, storage_options)
            return
        # A partial file was left by a killed run, because only one process writes to a run's folder.
        for left in Path(path).parent.glob(".*.ckpt.*.tmp"):
            left.unlink(missing_ok=True)
        # Serialised in memory first, because torch does not report a full disk reliably.
        buffer = BytesIO()
        torch.save(checkpoint, buffer)
        write_bytes(path, buffer.getbuffer())

    def remove_checkpoint(self, path: str | Path) -> None:
        """Remove a checkpoint that a better one replaces, if it is a file; folders are never removed."""
        if "://" in str(path):
            super().remove_checkpoint(path)
        else:
            Path(path).unlink(missing_ok=True)


def run_folder(root: str | None) -> str:
    """Return the folder of a run: ``trainer.default_root_dir``, or the working directory if it is not set."""
    return root or "."


def checkpoint_folder(root: str | None) -> str:
    """Return the folder of a run's checkpoints."""
    return str(Path(run_folder(root)) / "checkpoints")


def stopped_checkpoint(root: str | None) -> Path:
    """Return the path of the checkpoint that is saved when a run is stopped within an epoch."""
    return Path(checkpoint_folder(root)) / "stopped.ckpt"


def best_checkpoint(last: Path) -> Path | None:
    """Return a run's best checkpoint on the validation split, or None if no epoch was validated.

    Args:
        last: ``last.ckpt`` of the run, which records the best one; the folder may have moved. File times
            do not help, because a stopped and resumed run leaves a ``stopped.ckpt``.

    Raises:
        InputError: if ``last`` cannot be read, or the best checkpoint is missing.
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
        raise InputError(f"{best}, the best checkpoint of its run, is missing.")
    return best


def named_checkpoint(last: Path, name: str) -> Path:
    """Return the checkpoint with the name ``last`` or ``best``.

    Args:
        last: ``last.ckpt`` of the run.
        name: ``last`` or ``best``.

    Raises:
        InputError: if there is no best checkpoint.
    """
    if name == "last":
        return last
    best = best_checkpoint(last)
    if best is None:
        raise InputError(f"no epoch of the run of {last} was validated, so that none is its best.")
    return best


def check_unused(folder: Path, resumed: Path | None = None) -> None:
    """Check that the checkpoint folder of a run has no checkpoints of another run.

    Args:
        folder: checkpoint folder of the run.
        resumed: checkpoint to resume from. If it is in the folder, the other checkpoints belong to this
            run.

    Raises:
        InputError: if the folder holds checkpoints of another run.
    """
    if resumed is not None and resumed.parent.resolve() == folder.resolve():
        return
    first = [folder / "last.ckpt", stopped_checkpoint(str(folder.parent))]
    if there := next((path for path in [*first, *sorted(folder.glob("*.ckpt"))] if path.is_file()), None):
        raise InputError(
            f"{folder} holds a run already: resume it with --ckpt_path {there}, "
            "or give another --trainer.default_root_dir."
        )


def check_others(
    callbacks: Iterable[object], root: str | None, resumed: Path | None, known: set[str]
) -> None:
    """Check that no callback would overwrite a checkpoint of another run.

    Args:
        callbacks: callbacks of the run; only Lightning's checkpoint callbacks are checked.
        root: folder of the run.
        resumed: checkpoint to resume from.
        known: checkpoint folders recorded in ``resumed``.

    Raises:
        InputError: if a callback would overwrite one.
    """
    own = Path(checkpoint_folder(root)).resolve()
    for callback in callbacks:
        if not isinstance(callback, ModelCheckpoint) or "://" in str(callback.dirpath or ""):
            continue
        # A file name may contain a path, but the slash in a metric such as {val/angle:.2f} is not one.
        name = re.sub(r"\{.*?\}", "_", callback.filename or "_")
        folder = (Path(callback.dirpath or own) / name).resolve().parent
        if folder == own or str(folder) in known or (resumed and resumed.parent.resolve() == folder):
            continue
        if there := next(iter(sorted(folder.glob("*.ckpt"))), None):
            raise InputError(
                f"{folder} holds checkpoints of another run, such as {there.name}; "
                "give the callback that names it another dirpath or filename."
            )


def check_size(path: Path, trained: int | None, size: int) -> None:
    """Check the size that a model was trained at (None for any) against that of the data.

    Raises:
        InputError: if the sizes differ.
    """
    if trained not in {None, size}:
        raise InputError(f"{path} was trained at {trained} pixels, not {size}; data.size must be {trained}.")
