"""Warning filters: hide warnings that the user cannot act on, and show the others in one line each."""

import logging
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from normalgan.errors import tell

_NOT_SAID = (
    r".*does not have many workers.*",  # a small data set is kept in memory, where workers only add overhead
    r".*is smaller than the logging interval.*",
    r".*The dirpath has changed.*",  # a checkpoint from another folder is in use
    r".*Checkpoint directory .* exists and is not empty.*",  # a run was resumed
    # Lightning counts the steps of both optimisers; the order of samples depends only on seed and epoch.
    r".*resuming from a checkpoint that ended before the epoch ended.*",
    r"LightningCLI.s args parameter is intended.*",  # running in-process with explicit arguments is intended
)
"""Lightning warnings about things that are intended here."""
_LIBRARIES = r"(lightning|torch)\."
"""Modules with hidden deprecation warnings; warnings caused by plug-ins are shown."""


_INFO_NOT_SAID = re.compile(
    r"(GPU|TPU|HPU) available|Seed set to|Tip: For seamless|LOCAL_RANK|MPS available|"
    # Confirmations of settings, and of a run that ends or continues as requested.
    r"`Trainer\(|already configured with model summary|^`Trainer\.fit` stopped: `max_epochs|"
    r"Restor(ing|ed) |Loaded model weights|Loading `train_dataloader`|`weights_only` was not set|"
    r"Using .*(Automatic Mixed|AMP|precision)|Found current_model_state|"
    # From runs with several processes.
    r"Initializing distributed|distributed_backend=|All distributed processes|^-+$|"
    r"Detected KeyboardInterrupt|Received SIGTERM|Bypassing SIGTERM"  # reported by our own messages
)
"""Lightning's routine log messages; others, such as why a run stops or a profiler's report, are shown."""


class _InfoHandler(logging.Handler):
    """Prints Lightning's log messages to the current stderr in the format of our own."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a message unless it is filtered."""
        text = record.getMessage().strip("\n")
        if record.levelno <= logging.INFO and (not text.strip() or _INFO_NOT_SAID.search(text.strip())):
            return
        if "\n" in text:
            print(text, file=sys.stderr)
        else:
            tell(text)


_HANDLER = _InfoHandler()


def filter_warnings() -> None:
    """Filter and shorten warnings until the enclosing `warnings.catch_warnings` block ends."""
    logging.getLogger("lightning").handlers[:] = [_HANDLER]
    for name in ("lightning.pytorch", "lightning.fabric"):
        # Their own handlers would print a second time, next to that of "lightning".
        logger = logging.getLogger(name)
        logger.setLevel(logging.INFO)
        logger.handlers.clear()
        logger.propagate = True
    for expected in _NOT_SAID:
        warnings.filterwarnings("ignore", message=expected)
    for category in (DeprecationWarning, FutureWarning):
        warnings.filterwarnings("ignore", category=category, module=_LIBRARIES)
    warnings.showwarning = _show


def _show(message: Warning | str, *_: Any, **__: Any) -> None:
    tell(f"warning: {message}")


@contextmanager
def quiet_loggers(*names: str, level: int = logging.CRITICAL + 1) -> Iterator[None]:
    """Silence loggers below a level within the context."""
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(level)
    try:
        yield
    finally:
        for logger, before in zip(loggers, levels, strict=True):
            logger.setLevel(before)
