"""Globs: find the paths that match a pattern."""

from glob import escape, glob
from pathlib import Path


def matches(pattern: str) -> list[Path]:
    """Return the paths that match a glob, sorted; ``**`` matches any folders.

    Leading folders that exist are taken literally: artists name folders such as ``[WIP] tree``, and the
    shells of Windows pass globs on.
    """
    parts = Path(pattern).parts
    there = next((n for n in range(len(parts) - 1, 0, -1) if Path(*parts[:n]).is_dir()), 0)
    if there:
        pattern = str(Path(escape(str(Path(*parts[:there]))), *parts[there:]))
    return sorted(Path(found) for found in glob(pattern, recursive=True))
