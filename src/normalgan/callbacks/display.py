"""Output of training on the terminal: the networks before it, and a progress bar."""

import sys
from typing import Any

from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.callbacks import Callback, RichProgressBar
from torch.nn import Module

__all__ = ["NetworkSummary", "WideProgressBar", "count_parameters"]

_WIDE = 160
"""Columns of a log file, which has no width; Rich takes 80, which cuts the losses off."""


class WideProgressBar(RichProgressBar):
    """Lightning's bar: as wide as the terminal, wide enough for all losses in a file, epochs from 1."""

    def __init__(self) -> None:
        terminal = any(stream.isatty() for stream in (sys.stdout, sys.stderr) if stream is not None)
        super().__init__(console_kwargs=None if terminal else {"width": _WIDE})

    def on_train_epoch_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Name the epoch as people count, from 1."""
        super().on_train_epoch_start(trainer, pl_module)
        if self.progress is not None and self.train_progress_bar_id is not None:
            most = trainer.max_epochs
            of = f"/{most}" if most is not None and most > 0 else ""
            self.progress.update(
                self.train_progress_bar_id, description=f"Epoch {trainer.current_epoch + 1}{of}"
            )


class NetworkSummary(Callback):
    """Prints the networks and their numbers of parameters.

    Lightning's own summary counts FLOPs of an example input, which a model that reads batches of several
    tensors does not have: it prints 0.
    """

    def on_fit_start(self, trainer: Trainer, pl_module: LightningModule) -> None:
        """Print a line for each network."""
        if not trainer.is_global_zero:
            return
        for name, network in pl_module.named_children():
            if count := count_parameters(network):
                print(f"{name}: {_class_name(network)}, {_rounded(count)} parameters")


def count_parameters(network: Module) -> int:
    """Return how many numbers a network learns."""
    return sum(parameter.numel() for parameter in network.parameters() if parameter.requires_grad)


def _class_name(network: Module) -> str:
    original: Any = getattr(network, "_orig_mod", network)  # of torch.compile
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
