"""Files that are costly to make: one of the test processes makes them, the others wait and then read them."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder that is filled once in a run of the tests, in however many processes (pytest-xdist).

    Args:
        factory: pytest's of this process.
        name: of the folder.
        make: fills the folder, which is empty; where it fails, the next process tries again.

    Returns:
        The folder. Other processes read it at the same time: copy what is to be changed.
    """
    base = factory.getbasetemp()
    if base.name.startswith("popen-"):  # a worker's folder, in that of the run
        base = base.parent
    folder, finished = base / name, base / f"{name}.finished"
    with FileLock(base / f"{name}.lock"):
        if not finished.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            finished.touch()
    return folder
