"""Terminal output of training: a summary of the networks and a progress bar."""

import sys
from typing import Any

from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import Callback, RichProgressBar
from torch.nn import Module

_WIDE = 160
"""Line width for log files; Rich's default of 80 would cut the losses off."""


class WideProgressBar(RichProgressBar):
    """Lightning's progress bar with epochs counted from 1, and room for all losses in a log file."""

    def __init__(self) -> None:
        terminal = any(stream.isatty() for stream in (sys.stdout, sys.stderr) if stream is not None)
        super().__init__(console_kwargs=None if terminal else {"width": _WIDE})

    def get_metrics(
        self, trainer: Trainer, pl_module: LightningModule
    ) -> dict[str, int | str | float | dict[str, float]]:
        """Return the losses without ``v_num``, which joins the loggers' versions; a run has a folder."""
        return {
            name: value for name, value in super().get_metrics(trainer, pl_module).items() if name != "v_num"
        }

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Show the number of the epoch, from 1."""
        super().on_train_epoch_start(trainer, pl_module)
        if self.progress is not None and self.train_progress_bar_id is not None:
            most = trainer.max_epochs
            of = f"/{most}" if most is not None and most > 0 else ""
            self.progress.update(
                self.train_progress_bar_id, description=f"Epoch {trainer.current_epoch + 1}{of}"
            )


class NetworkSummary(Callback):
    """Prints the networks and their numbers of parameters.

    Lightning's own summary counts FLOPs for an example input. A model with batches of several tensors has
    none, so it prints 0.
    """

    def on_fit_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Print one line per network."""
        if not trainer.is_global_zero:
            return
        for name, network in pl_module.named_children():
            if count := count_parameters(network):
                print(f"{name}: {_class_name(network)}, {_rounded(count)} parameters")


def count_parameters(network: Module) -> int:
    """Return the number of trainable parameters of a network."""
    return sum(parameter.numel() for parameter in network.parameters() if parameter.requires_grad)


def _class_name(network: Module) -> str:
    original: Any = getattr(network, "_orig_mod", network)  # from torch.compile
    return type(original).__name__


def _rounded(count: int) -> str:
    """Return a count as text.

    >>> _rounded(54_414_979), _rounded(65_900), _rounded(12)
    ('54.4 million', '65.9 thousand', '12')
    """
    for unit, word in ((10**6, "million"), (10**3, "thousand")):
        if count >= unit:
            return f"{count / unit:.1f} {word}"
    return str(count)
