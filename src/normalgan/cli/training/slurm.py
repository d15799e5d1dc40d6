"""SLURM: let a job that is stopped and requeued continue its run."""

import os
import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import current_thread, main_thread

from lightning.fabric.plugins import ClusterEnvironment
from lightning.fabric.plugins.environments.slurm import SLURMEnvironment

from normalgan.callbacks.checkpoints import checkpoint_folder, run_folder, stopped_checkpoint
from normalgan.callbacks.stopped import requeue_job
from normalgan.errors import InputError


def with_slurm(plugins: Iterable[object]) -> list[object]:
    """Return the trainer's plugins; under SLURM, with an environment that does not requeue by itself.

    Lightning's requeue saves ``hpc_ckpt_1.ckpt`` in a signal handler, possibly between the steps of the two
    networks. Later commands in the same folder, even test, then load it instead of the given checkpoint.
    `StoppedCheckpoint` saves and requeues between batches.

    Raises:
        InputError: if SLURM does not set the number of tasks per node.
    """
    given = list(plugins)
    if not SLURMEnvironment.detect() or any(isinstance(each, ClusterEnvironment) for each in given):
        return given
    try:
        return [*given, SLURMEnvironment(auto_requeue=False)]
    except RuntimeError as error:
        tasks = os.environ["SLURM_NTASKS"]
        raise InputError(
            f"SLURM has {tasks} tasks (--ntasks) but no number of tasks per node; pass "
            f"--ntasks-per-node={tasks} to sbatch or srun instead, or set SLURM_JOB_NAME=bash for one."
        ) from error


@contextmanager
def requeued_on_signal() -> Iterator[None]:
    """Requeue a SLURM job and end the command on SIGUSR1, within the context.

    Use it before training, for example while samples are rendered. When training starts,
    `StoppedCheckpoint` installs its own handler, which saves a checkpoint first.
    """
    if (
        not SLURMEnvironment.detect()
        or current_thread() is not main_thread()
        or not hasattr(signal, "SIGUSR1")
    ):
        yield
        return

    def requeue(*_: object) -> None:
        if os.environ.get("SLURM_PROCID", "0") == "0":  # the signal reaches all tasks
            requeue_job()
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGUSR1, requeue)
    try:
        yield
    finally:
        signal.signal(signal.SIGUSR1, before)


def check_left_behind(root: str | None) -> None:
    """Check that a run's folder has no checkpoint of Lightning's own requeue, which it would load unchecked.

    Raises:
        InputError: if the folder has such a checkpoint.
    """
    left = sorted(Path(run_folder(root)).glob("hpc_ckpt_*.ckpt"))
    if left and SLURMEnvironment.detect():
        raise InputError(
            f"under SLURM, Lightning would use {left[-1]} instead of any other checkpoint; move it into "
            f"{checkpoint_folder(root)}, and name it with --ckpt_path to resume it."
        )


def restarted_from(root: str | None) -> Path | None:
    """Return the checkpoint from which a requeued job continues its run.

    This is the newer of ``last.ckpt`` and ``stopped.ckpt``, so that jobs shorter than an epoch make progress.

    Args:
        root: folder of the run.

    Returns:
        The path of the checkpoint; None if the job was not requeued, or nothing was saved before.
    """
    if os.environ.get("SLURM_RESTART_COUNT", "0") == "0":
        return None
    paths = [Path(checkpoint_folder(root)) / "last.ckpt", stopped_checkpoint(root)]
    return max(filter(Path.is_file, paths), key=lambda path: path.stat().st_mtime, default=None)
