"""Warning filters: hide warnings that the user cannot act on, and show the rest in one line each."""

import logging
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from normalgan.errors import tell

__all__ = ["INFO_NOT_SAID", "NOT_SAID", "filter_warnings", "quiet_loggers"]

NOT_SAID = (
    r".*does not have many workers.*",  # a small data set lies in memory, where workers only cost
    r".*is smaller than the logging interval.*",
    r".*The dirpath has changed.*",  # a checkpoint is used from another folder; its own keeps the best
    r".*Checkpoint directory .* exists and is not empty.*",  # a run that is resumed
    # It counts the steps of both optimisers, and our order of samples depends on seed and epoch alone.
    r".*resuming from a checkpoint that ended before the epoch ended.*",
    r"LightningCLI.s args parameter is intended.*",  # we do run in-process, with the arguments we mean
)
"""Warnings of Lightning about what we do on purpose."""
_LIBRARIES = r"(lightning|torch)\."
"""Modules that call what other libraries have deprecated; a plug-in's own calls are shown."""


INFO_NOT_SAID = re.compile(
    r"(GPU|TPU|HPU) available|Seed set to|Tip: For seamless|LOCAL_RANK|MPS available|"
    # Of settings that were given, and of a run that ends or goes on as asked.
    r"`Trainer\(|already configured with model summary|^`Trainer\.fit` stopped: `max_epochs|"
    r"Restor(ing|ed) |Loaded model weights|Loading `train_dataloader`|`weights_only` was not set|"
    r"Using .*(Automatic Mixed|AMP|precision)|Found current_model_state|"
    # Of several processes.
    r"Initializing distributed|distributed_backend=|All distributed processes|^-+$|"
    r"Detected KeyboardInterrupt|Received SIGTERM|Bypassing SIGTERM"  # those we tell ourselves
)
"""What Lightning logs and nobody asks for; the rest is shown: why a run stops, what a profiler measured."""


class _InfoHandler(logging.Handler):
    """Prints Lightning's log messages to the current stderr as our own sentences."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a message, unless it is filtered."""
        text = record.getMessage().strip("\n")
        if record.levelno <= logging.INFO and (not text.strip() or INFO_NOT_SAID.search(text.strip())):
            return
        if "\n" in text:
            print(text, file=sys.stderr)
        else:
            tell(text)


_HANDLER = _InfoHandler()


def filter_warnings() -> None:
    """Filter and shorten warnings until the surrounding `warnings.catch_warnings` ends."""
    logging.getLogger("lightning").handlers[:] = [_HANDLER]
    for name in ("lightning.pytorch", "lightning.fabric"):
        # Without handlers of the root logger they have some of their own; with them, "lightning" prints too.
        logger = logging.getLogger(name)
        logger.setLevel(logging.INFO)
        logger.handlers.clear()
        logger.propagate = True
    for expected in NOT_SAID:
        warnings.filterwarnings("ignore", message=expected)
    for category in (DeprecationWarning, FutureWarning):
        warnings.filterwarnings("ignore", category=category, module=_LIBRARIES)
    warnings.showwarning = _show


def _show(message: Warning | str, *_: Any, **__: Any) -> None:
    tell(f"warning: {message}")


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
