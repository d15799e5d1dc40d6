"""What the tests of the command line share: meshes with a cache, and a trained run."""

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from made_once import made_once

if TYPE_CHECKING:
    from command import Bench  # it loads torch, which most tests do not need


@pytest.fixture(scope="session", name="bench")
def make_bench(meshes: Path, cache: Path) -> "Bench":
    """The meshes and the cache that all tests share."""
    from command import Bench

    return Bench(meshes, cache)


@pytest.fixture(scope="session", name="trained")
def make_trained(meshes: Path, cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that has learnt that there are objects: a copy, and its samples in the cache."""
    from command import Bench

    def train(folder: Path) -> None:
        outcome = Bench(meshes, folder / "cache").run("fit", folder / "run", "--trainer.max_epochs", 8)
        assert outcome.code == 0, outcome.err

    folder = made_once(tmp_path_factory, "trained", train)
    shutil.copytree(folder / "cache", cache, dirs_exist_ok=True)
    copy = tmp_path_factory.mktemp("trained") / "run"
    shutil.copytree(folder / "run", copy)
    return copy
