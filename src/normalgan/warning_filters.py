"""Warning filters: hide warnings that the user cannot act on, and show the rest in one line each."""

import logging
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from normalgan.errors import one_line

__all__ = ["NOT_SAID", "filter_warnings", "quiet_loggers"]

NOT_SAID = (
    r".*does not have many workers.*",  # a small data set lies in memory, where workers only cost
    r".*is smaller than the logging interval.*",
    r".*The dirpath has changed.*",  # a checkpoint is used from another folder; its own keeps the best
    r".*Checkpoint directory .* exists and is not empty.*",  # a run that is resumed
    # It counts the steps of both optimisers, and our order of samples depends on seed and epoch alone.
    r".*resuming from a checkpoint that ended before the epoch ended.*",
    r".*LeafSpec.*is deprecated.*",  # torch's and lightning's own
    r"[\s\S]*JSONARGPARSE_DEPRECATION_WARNINGS",  # between lightning and jsonargparse, said once a process
    r"[\s\S]* was deprecated in v4\.\d+\.\d+ and will be removed in v5",  # the same, of each call by itself
    r"LightningCLI.s args parameter is intended.*",  # we do run in-process, with the arguments we mean
)
"""Warnings of Lightning about what we do on purpose."""


def filter_warnings() -> None:
    """Filter and shorten warnings until the surrounding `warnings.catch_warnings` ends."""
    # What hardware there is not, the seed, advertisements.
    for name in ("lightning.pytorch", "lightning.fabric"):
        logging.getLogger(name).setLevel(logging.WARNING)
    for expected in NOT_SAID:
        warnings.filterwarnings("ignore", message=expected)
    warnings.showwarning = _show


def _show(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"normalgan: warning: {one_line(str(message))}", file=sys.stderr)


@contextmanager
def quiet_loggers(*names: str, level: int = logging.CRITICAL + 1) -> Iterator[None]:
    """Silence loggers below a level inside the context."""
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(level)
    try:
        yield
    finally:
        for logger, before in zip(loggers, levels, strict=True):
            logger.setLevel(before)
