"""Checkpoints: written atomically, and checked before they are used."""

import re
from collections.abc import Iterable, Mapping
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

__all__ = [
    "AtomicCheckpointIO",
    "LastCheckpoint",
    "best_checkpoint",
    "check_others",
    "check_size",
    "check_sizes",
    "check_unused",
    "checkpoint_folder",
    "named_checkpoint",
    "run_folder",
    "stopped_checkpoint",
]


class LastCheckpoint(ModelCheckpoint):
    """Saves ``last.ckpt`` after every epoch, so that a killed run loses at most one epoch.

    A run that ``max_steps`` or ``max_time`` stops within an epoch saves it after its last batch. If it were
    saved later, the epoch would count as complete.

    Since 2.6, Lightning's own ``save_last`` saves only together with a new best, and before the end of an
    epoch that is not validated, so that resuming goes wrong.
    """

    def __init__(self) -> None:
        super().__init__(filename="last", save_on_train_epoch_end=True, enable_version_counter=False)

    def setup(self, trainer: Trainer, pl_module: LightningModule, stage: str) -> None:
        """Set the folder of the run."""
        self.dirpath = checkpoint_folder(trainer.default_root_dir)
        super().setup(trainer, pl_module, stage)

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: Any, batch: Any, batch_idx: int
    ) -> None:
        """Save if the run stops here, within an epoch."""
        loop = trainer.fit_loop.epoch_loop
        if loop.done and not loop.batch_progress.is_last_batch:
            super().on_train_epoch_end(trainer, pl_module)

    def on_train_epoch_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Save, if the whole epoch was trained."""
        if trainer.fit_loop.epoch_loop.batch_progress.is_last_batch:
            super().on_train_epoch_end(trainer, pl_module)


class AtomicCheckpointIO(TorchCheckpointIO):
    """Writes a checkpoint beside its target and renames it, so that a killed run never leaves half a file.

    Lightning writes to the system's temporary folder. From another disk a file is copied, not renamed, over
    the last checkpoint.
    """

    def save_checkpoint(
        self, checkpoint: dict[str, Any], path: str | Path, storage_options: Any | None = None
    ) -> None:
        """Save a checkpoint as a file or under a URL."""
        if "://" in str(path):  # object stores show only complete objects
            super().save_checkpoint(checkpoint, path, storage_options)
            return
        # Left half written by a killed run; only one process writes to a run's folder.
        for left in Path(path).parent.glob(".*.ckpt.*.tmp"):
            left.unlink(missing_ok=True)
        # In memory first, because torch does not report a full disk reliably.
        buffer = BytesIO()
        torch.save(checkpoint, buffer)
        write_bytes(path, buffer.getbuffer())

    def remove_checkpoint(self, path: str | Path) -> None:
        """Remove a checkpoint that a better one replaces: a file, never a whole folder."""
        if "://" in str(path):
            super().remove_checkpoint(path)
        else:
            Path(path).unlink(missing_ok=True)


def run_folder(root: str | None) -> str:
    """Return the folder of a run: ``trainer.default_root_dir``, or the working directory without it."""
    return root or "."


def checkpoint_folder(root: str | None) -> str:
    """Return the folder of a run's checkpoints."""
    return str(Path(run_folder(root)) / "checkpoints")


def stopped_checkpoint(root: str | None) -> Path:
    """Return the path of the checkpoint that a run stopped within an epoch leaves."""
    return Path(checkpoint_folder(root)) / "stopped.ckpt"


def best_checkpoint(last: Path) -> Path | None:
    """Return a run's best checkpoint on the validation split; None if none was measured.

    Args:
        last: ``last.ckpt`` of the run, which names it; the run's folder may have moved. File times do not
            help: a stopped and resumed run leaves ``stopped.ckpt`` behind.

    Raises:
        InputError: if it cannot be read, or the best checkpoint is missing.
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
        name: ``last`` or ``best``.

    Raises:
        InputError: if there is no best one.
    """
    if name == "last":
        return last
    best = best_checkpoint(last)
    if best is None:
        raise InputError(f"no epoch of the run of {last} was validated, so that none is its best.")
    return best


def check_unused(folder: Path, resumed: Path | None = None) -> None:
    """Check that the folder of a run's checkpoints holds none of another run.

    Args:
        folder: where the run will write.
        resumed: the checkpoint that it resumes, which lies there if the others are its own.

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
        callbacks: callbacks of the run; only Lightning's checkpoint callbacks matter.
        root: folder of the run.
        resumed: the checkpoint that it resumes.
        known: folders that ``resumed`` says its run wrote to.

    Raises:
        InputError: if one would.
    """
    own = Path(checkpoint_folder(root)).resolve()
    for callback in callbacks:
        if not isinstance(callback, ModelCheckpoint) or "://" in str(callback.dirpath or ""):
            continue
        # A name may lead out of the folder; the slash of a metric, such as {val/angle:.2f}, does not.
        name = re.sub(r"\{.*?\}", "_", callback.filename or "_")
        folder = (Path(callback.dirpath or own) / name).resolve().parent
        if folder == own or str(folder) in known or (resumed and resumed.parent.resolve() == folder):
            continue
        if there := next(iter(sorted(folder.glob("*.ckpt"))), None):
            raise InputError(
                f"{folder} holds checkpoints of another run, such as {there.name}; "
                "give the callback that names it another dirpath or filename."
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
        raise InputError(f"{path} was trained at {trained} pixels, not {size}; data.size must be {trained}.")
