"""Watching: which of some files were saved since they were last looked at, and are whole by now."""

from collections.abc import Iterable
from pathlib import Path

__all__ = ["Stamp", "Watcher"]

Stamp = tuple[int, int]


class Watcher:
    """Tells which files are new or were saved again.

    A program takes a while to save: a file counts once it has been the same at two looks. Files are looked at
    again and again, as the system's own messages do not come from network folders.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     drawing = Path(folder) / "a.png"
        ...     watcher = Watcher([])
        ...     _ = drawing.write_bytes(b"1")
        ...     looks = [watcher.saved([drawing]) for _ in range(3)]
        >>> [len(look) for look in looks]
        [0, 1, 0]
    """

    def __init__(self, files: Iterable[Path]) -> None:
        self._done = {path: _stamp(path) for path in files}
        self._last: dict[Path, Stamp | None] = {}

    def saved(self, files: Iterable[Path]) -> list[Path]:
        """Return the files that were saved and are whole; each once."""
        now = {path: _stamp(path) for path in files}
        settled = [
            path
            for path, stamp in now.items()
            if stamp is not None and stamp != self._done.get(path) and stamp == self._last.get(path)
        ]
        self._last = now
        self._done |= {path: now[path] for path in settled}
        return settled


def _stamp(path: Path) -> Stamp | None:
    """Return what changes when a file is saved; None if it is gone."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
