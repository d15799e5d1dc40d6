"""What the tests of the command line share. Imported by each, because one folder of tests has a conftest."""

from functools import cache as remember
from pathlib import Path

import pytest
from command import Bench


@pytest.fixture(scope="session", name="bench")
def make_bench(meshes: Path, cache: Path) -> Bench:
    """The meshes and the cache that all tests share."""
    return Bench(meshes, cache)


@pytest.fixture(scope="session", name="trained")
def make_trained(bench: Bench) -> Path:
    """The folder of a run that has learnt that there are objects."""
    return _train(bench)


@remember
def _train(bench: Bench) -> Path:
    # Every module that imports the fixture would else train anew.
    folder = bench.cache.with_name("trained") / "run"
    outcome = bench.run("fit", folder, "--trainer.max_epochs", 8)
    assert outcome.code == 0, outcome.err
    return folder
