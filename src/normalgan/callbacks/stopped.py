"""StoppedCheckpoint: what was learnt until a run was stopped in the middle of an epoch."""

import sys

from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.checkpoints import stopped_checkpoint
from normalgan.objectives.finite import LossError


class StoppedCheckpoint(Callback):
    """Saves ``stopped.ckpt`` where a job is preempted (SIGTERM) or a loss is no longer finite.

    ``last.ckpt`` stays that of the last whole epoch: from there a run goes on as if it had never been
    stopped. After SIGTERM it can go on from this one too, with what was learnt since, but need not end in the
    same weights. After a loss that is not finite the weights in it are sound, but the running statistics of
    batch norm have seen the batch: it is there to be looked at.
    """

    def on_exception(self, trainer: Trainer, pl_module: LightningModule, exception: BaseException) -> None:
        """Save, and say where."""
        if not isinstance(exception, SIGTERMException | LossError):
            return
        if trainer.sanity_checking or trainer.fast_dev_run:  # type: ignore[attr-defined]  # set from outside
            return
        path = stopped_checkpoint(trainer.default_root_dir)
        trainer.save_checkpoint(path)
        if isinstance(exception, LossError):
            exception.keep(path)
        elif trainer.is_global_zero:
            print(f"normalgan: stopped by SIGTERM; resume with --ckpt_path {path}.", file=sys.stderr)
