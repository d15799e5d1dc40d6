import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import pytest

from normalgan.errors import InputError
from normalgan.files.run_lock import NAME, one_run_in

CONF = Path(__file__).parents[1] / "conf" / "tiny.yaml"
WITHOUT_FCNTL = """\
import json, sys
sys.modules["fcntl"] = None
from normalgan.__main__ import main
for arguments in json.loads(sys.argv[1]):
    assert main(arguments) == 0, arguments
"""


def test_a_folder_is_held_once_and_let_go(tmp_path: Path) -> None:
    with one_run_in(tmp_path / "run"):
        assert (tmp_path / "run" / NAME).exists()
        with pytest.raises(InputError, match="another run trains in"), one_run_in(tmp_path / "run"):
            pass
    assert not (tmp_path / "run" / NAME).exists()
    (tmp_path / "run").mkdir(exist_ok=True)
    (tmp_path / "run" / NAME).touch()  # as a run that was killed leaves it
    with one_run_in(tmp_path / "run"):
        pass


def test_folders_that_were_made_for_a_run_that_left_nothing_are_removed(tmp_path: Path) -> None:
    with one_run_in(tmp_path / "runs" / "first"):
        pass
    assert not (tmp_path / "runs").exists()
    with one_run_in(tmp_path / "runs" / "first"):
        (tmp_path / "runs" / "first" / "config.yaml").touch()
    with one_run_in(tmp_path / "runs" / "second"):
        pass
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["first"]
    (tmp_path / "own").mkdir()
    with one_run_in(tmp_path / "own"):  # was there before
        pass
    assert (tmp_path / "own").is_dir()


def test_a_file_system_without_locks_is_said_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fcntl = pytest.importorskip("fcntl")

    def no_locks(*_: object) -> NoReturn:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    with (
        pytest.raises(
            InputError, match=r"cannot be locked for this run \(No locks available\); give a --trainer"
        ),
        one_run_in(tmp_path / "run"),
    ):
        pass


@pytest.mark.slow  # imports lightning and trains, in a process of its own
def test_commands_start_without_fcntl(tmp_path: Path, meshes: Path) -> None:
    arguments = [
        *("--config", CONF, "--data.meshes", meshes, "--data.cache", tmp_path / "cache"),
        *("--trainer.default_root_dir", tmp_path / "run", "--trainer.limit_train_batches", 1),
    ]
    drawing = Path(__file__).parents[2] / "examples" / "sketches" / "horse.png"
    predict = [
        "--data.prediction.sketches",
        drawing,
        "--trainer.accelerator",
        "cpu",
        "--output.folder",
        tmp_path / "maps",
    ]
    commands = [["render", *arguments], ["fit", *arguments], ["predict", *predict]]
    told = json.dumps([[str(word) for word in command] for command in commands])
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_FCNTL, told], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run" / "checkpoints" / "last.ckpt").is_file()
    assert any((tmp_path / "maps").iterdir())
