"""Watching: find files that were saved since the last check and are complete."""

from collections.abc import Iterable, Mapping
from pathlib import Path

Stamp = tuple[tuple[Path, int, int] | None, ...]
"""State of a drawing and of all files read for it; it changes when one of them is saved."""


class Watcher:
    """Finds drawings that were added or saved again, or whose hints or mask were saved.

    Saving takes a while, so a file counts as complete when two successive checks find it unchanged. Files are
    polled, because network folders do not send notifications.

    Args:
        files: drawings that are already done, each with the other files read for it.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     drawing = Path(folder) / "a.png"
        ...     watcher = Watcher({})
        ...     _ = drawing.write_bytes(b"1")
        ...     looks = [watcher.saved({drawing: []}) for _ in range(3)]
        >>> [len(look) for look in looks]
        [0, 1, 0]
    """

    def __init__(self, files: Mapping[Path, Iterable[Path]]) -> None:
        self._done = {path: _stamp(path, companions) for path, companions in files.items()}
        self._last: dict[Path, Stamp | None] = {}

    def saved(self, files: Mapping[Path, Iterable[Path]]) -> list[Path]:
        """Return the drawings to predict now."""
        now = {path: _stamp(path, companions) for path, companions in files.items()}
        settled = [
            path
            for path, stamp in now.items()
            if stamp is not None and stamp != self._done.get(path) and stamp == self._last.get(path)
        ]
        self._last = now
        self._done |= {path: now[path] for path in settled}
        return settled


def _stamp(path: Path, companions: Iterable[Path]) -> Stamp | None:
    """Return a value that changes when a drawing or a file read for it is saved; None without a drawing."""
    own = _look(path)
    return None if own is None else (own, *map(_look, companions))


def _look(path: Path) -> tuple[Path, int, int] | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return path, status.st_mtime_ns, status.st_size
