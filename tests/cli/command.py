"""Running a command as a user does, but in this process."""

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path

import torch

from normalgan.__main__ import main

torch.set_num_threads(1)  # pictures this small are slower with more, above all on a busy machine

CONF = Path(__file__).parents[1] / "conf"


@dataclass(frozen=True)
class Outcome:
    """What a command leaves behind: exit code and what it said."""

    code: int
    out: str
    err: str

    def refused(self, *words: str, code: int = 2) -> None:
        """Hold it to one sentence on the error stream, with these words in it."""
        lines = [line for line in self.err.splitlines() if not line.lstrip().startswith("rendering")]
        assert self.code == code, self.err
        assert len(lines) == 1, self.err
        assert lines[0].startswith("normalgan: ")
        assert len(lines[0]) < 400, self.err
        assert "Traceback" not in self.err
        for word in words:
            assert word in lines[0]


@dataclass(frozen=True)
class Bench:
    """Small meshes, and a cache that the tests share."""

    meshes: Path
    cache: Path

    def run(self, command: str, folder: Path, *arguments: object) -> Outcome:
        """Run a command with its run's folder and more arguments on tiny.yaml."""
        return run(
            command,
            *("--config", CONF / "tiny.yaml"),
            *("--data.meshes", self.meshes),
            *("--data.cache", self.cache),
            *("--trainer.default_root_dir", folder),
            *arguments,
        )


def run(*arguments: object) -> Outcome:
    """Run a command with these arguments alone."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return Outcome(code, out.getvalue(), err.getvalue())


def left_in(folder: Path) -> list[str]:
    """Return the names of all files under a folder."""
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())
