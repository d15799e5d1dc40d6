"""StoppedCheckpoint: saves a checkpoint when a run is stopped within an epoch."""

import os
import signal
import subprocess
from threading import current_thread, main_thread
from types import FrameType
from typing import Any

from lightning.fabric.plugins.environments.slurm import SLURMEnvironment
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks.checkpoints import stopped_checkpoint
from normalgan.errors import tell
from normalgan.losses.finite import LossError


class StoppedCheckpoint(Callback):
    """Saves ``stopped.ckpt`` when a job is preempted (SIGTERM) or a loss is no longer finite.

    ``last.ckpt`` still holds the last complete epoch, and a run resumed from it ends with the same weights
    as an uninterrupted run. After SIGTERM, resuming from ``stopped.ckpt`` loses no training, but may end
    with different weights. After a non-finite loss, the weights in it are sound, but batch norm's running
    statistics include the bad batch, so use it only to look for the cause.

    With several processes, Lightning's SIGTERM handler itself sends a message to the others. In the middle
    of another collective operation, this deadlocks all processes. Here the handler only sets a flag, and
    the processes check it together before each batch.

    Under SLURM, SIGUSR1 (``sbatch --signal=SIGUSR1@120``) does the same and requeues the job.

    Ctrl-C is remembered, because Python drops a KeyboardInterrupt that is raised within a destructor.
    """

    def __init__(self) -> None:
        self._asked = self._interrupted = False
        self._requeue = self._validating = False

    def on_train_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Replace the signal handlers; Lightning restores the original ones when training ends."""
        if current_thread() is not main_thread():
            return
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._interrupt)
        if trainer.world_size > 1:
            signal.signal(signal.SIGTERM, self._note)
        if SLURMEnvironment.detect() and hasattr(signal, "SIGUSR1"):  # Windows has no SIGUSR1
            signal.signal(signal.SIGUSR1, self._note)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self._interrupted = True
        signal.default_int_handler(number, frame)

    def _note(self, number: int, *_: object) -> None:
        self._asked = True
        self._requeue = self._requeue or number != signal.SIGTERM

    def on_train_batch_start(
        self, trainer: Trainer, pl_module: LightningModule, batch: Any, batch_idx: int
    ) -> None:
        """Stop all processes if one of them received a signal."""
        self._agree(trainer)

    def on_validation_batch_start(
        self,
        trainer: Trainer,
        pl_module: LightningModule,
        batch: Any,
        batch_idx: int,
        dataloader_idx: int = 0,
    ) -> None:
        """Stop all processes if one received a signal; all of them validate the same number of batches."""
        if trainer.state.fn == TrainerFn.FITTING and not trainer.sanity_checking:
            self._agree(trainer)

    def _agree(self, trainer: Trainer) -> None:
        if self._interrupted:
            raise KeyboardInterrupt
        asked = self._asked
        if trainer.world_size > 1:
            asked = trainer.strategy.reduce_boolean_decision(asked, all=False)
        if asked:
            raise SIGTERMException

    def on_exception(self, trainer: Trainer, pl_module: LightningModule, exception: BaseException) -> None:
        """Save the checkpoint and print its path."""
        if not isinstance(exception, SIGTERMException | LossError):
            return
        if trainer.sanity_checking or trainer.fast_dev_run:  # type: ignore[attr-defined]  # set by Lightning, not typed
            return
        path = stopped_checkpoint(trainer.default_root_dir)
        self._validating = trainer.validating
        trainer.save_checkpoint(path)
        self._validating = False
        if isinstance(exception, LossError):
            exception.keep(path)
        elif trainer.is_global_zero:
            name = "SIGUSR1" if self._requeue else "SIGTERM"
            tell(f"stopped by {name}; resume with --ckpt_path {path}.")
            if self._requeue:
                requeue_job()

    def on_save_checkpoint(
        self, trainer: Trainer, pl_module: LightningModule, checkpoint: dict[str, Any]
    ) -> None:
        """Let a run that is stopped while it validates validate again when it is resumed.

        Lightning does so only if a batch of the validation has been started but not finished. We stop
        between batches, where it would skip the rest, and with it the epoch's error and best checkpoint.
        """
        if self._validating:
            progress = checkpoint["loops"]["fit_loop"]["epoch_loop.val_loop.batch_progress"]
            for counts in (progress["total"], progress["current"]):
                counts.update(dict.fromkeys(counts, 0))
            progress["total"].update(ready=1, started=1)


def requeue_job() -> None:
    """Ask SLURM to start the job again, and say so. It may end this process at once."""
    job = os.environ.get("SLURM_JOB_ID", "")
    if "SLURM_ARRAY_JOB_ID" in os.environ:
        job = f"{os.environ['SLURM_ARRAY_JOB_ID']}_{os.environ['SLURM_ARRAY_TASK_ID']}"
    try:
        done = subprocess.run(["scontrol", "requeue", job], check=False, capture_output=True, text=True)
        reason = done.stderr.strip() or f"exit code {done.returncode}" if done.returncode else ""
    except OSError as error:
        reason = str(error.strerror)
    tell(f"job {job} {f'was not requeued: {reason}' if reason else 'is requeued'}.")
