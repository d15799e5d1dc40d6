import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from command import Bench, left_in


def failing(number: int) -> Callable[..., None]:
    """Stands in for a call to the system; how a disk that is full, or read-only, answers it."""

    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return fail


@pytest.mark.parametrize(
    ("number", "code", "words"),
    [(errno.ENOSPC, 1, "No space left on device"), (errno.EROFS, 2, "Read-only file system")],
)
def test_an_unwritable_cache_is_one_sentence(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, code: int, words: str
) -> None:
    monkeypatch.setattr(Path, "write_bytes", failing(number))
    outcome = bench.run("fit", tmp_path / "run", "--data.cache", tmp_path / "cache")
    outcome.refused("cannot write the samples to", str(tmp_path / "cache"), words, code=code)
    assert left_in(tmp_path) == []


def test_a_cache_below_a_file(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    outcome = bench.run("render", tmp_path / "run", "--data.cache", tmp_path / "file" / "cache")
    outcome.refused("cannot write the samples to", "Not a directory")


def test_a_finished_cache_may_be_read_only(
    bench: Bench, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "write_bytes", failing(errno.EROFS))
    outcome = bench.run("fit", tmp_path / "run")
    assert outcome.code == 0, outcome.err


@pytest.mark.slow
def test_a_full_disk_leaves_the_last_checkpoint_whole(
    bench: Bench, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = tmp_path / "run"
    shutil.copytree(trained, run)
    last = run / "checkpoints" / "last.ckpt"
    before, names = last.read_bytes(), left_in(run / "checkpoints")
    monkeypatch.setattr("normalgan.files.writing.os.fsync", failing(errno.ENOSPC))
    outcome = bench.run("fit", run, "--ckpt_path", last, "--trainer.max_epochs", 9)
    outcome.refused("the disk is full at", ".ckpt; free some space", code=1)
    assert left_in(run / "checkpoints") == names
    assert last.read_bytes() == before


@pytest.mark.slow
def test_half_written_files_of_a_killed_run_are_removed(bench: Bench, trained: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    shutil.copytree(trained, run)
    left = run / "checkpoints" / ".last.ckpt.12345.tmp"
    left.write_bytes(b"half")
    outcome = bench.run("fit", run, "--ckpt_path", "last", "--trainer.max_epochs", 9)
    assert outcome.code == 0, outcome.err
    assert not left.exists()
