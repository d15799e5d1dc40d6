import contextlib
import errno
import os
import pty
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from torch import Generator, Tensor, zeros

import normalgan
from normalgan.__main__ import COMMANDS, TRAINING_LIBRARIES, main
from normalgan.errors import InputError, unwritable
from normalgan.hints import HintSampler
from normalgan.hints.draw import draw_hints


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    usage = capsys.readouterr().out
    assert all(f"\n  {command} " in usage for command in COMMANDS)
    assert main([]) == 2  # what to do was not said
    assert capsys.readouterr().out == usage


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"normalgan {normalgan.__version__}\n"


def test_an_unknown_command_is_answered_by_its_near_miss(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ftt"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err == (
        "normalgan: no command named 'ftt'. Did you mean fit? "
        "The commands are fit, validate, test, predict, render, sketch, generate, convert, mcp, studio, "
        "export, benchmark, models, plugins, completion.\n"
    )


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_has_ended_is_no_failure(unbuffered: str) -> None:
    """As in ``normalgan --help | head -1``."""
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(
        [sys.executable, "-m", "normalgan", "--help"],
        env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        stdout=write,
        stderr=subprocess.PIPE,
        check=False,
    )
    os.close(write)
    assert (ended.returncode, ended.stderr) == (141, b"")


@pytest.mark.parametrize(
    ("error", "code", "sentence"),
    [
        (InputError("no such\n  mesh."), 2, "no such mesh."),
        (unwritable("cannot write.", OSError(errno.ENOSPC, "full")), 1, "cannot write."),
        (unwritable("cannot write.", OSError(errno.EROFS, "read-only")), 2, "cannot write."),
        (OSError(errno.ENOSPC, "No space", "a.ckpt"), 1, "the disk is full at a.ckpt; free some space and"),
        (OSError(errno.EROFS, "Read-only", "a.ckpt"), 1, "no permission to write a.ckpt; choose another"),
        (OSError(errno.EIO, "Input/output error", "a"), 1, "failed while reading or writing a: Input/output"),
        (MemoryError(), 1, "out of memory; reduce data.batch_size"),
        (RuntimeError("DefaultCPUAllocator: can't allocate memory: you tried"), 1, "out of memory; reduce"),
        (RuntimeError("CUDA out of memory. Tried to allocate 2 GiB\nmore"), 1, "out of memory; reduce"),
        (
            RuntimeError("odd\nlong story"),
            1,
            "failed while running: RuntimeError: odd (set NORMALGAN_TRACEBACK",
        ),
        (KeyboardInterrupt(), 130, "stopped."),
        (
            InputError("the mesh \x1b]0;owned\x07 is\u202e bad."),
            2,
            r"the mesh \x1b]0;owned\x07 is\u202e bad.",
        ),
    ],
)
def test_what_goes_wrong_is_a_sentence_and_a_code(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    code: int,
    sentence: str,
) -> None:
    def run(_: list[str]) -> int:
        raise error

    monkeypatch.setattr("normalgan.cli.training.command.run", run)
    assert main(["fit"]) == code
    said = capsys.readouterr().err
    assert said.startswith(f"normalgan: {sentence}")
    assert said.count("\n") == 1


def test_a_bug_in_somebody_elses_class_is_told_with_its_place(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Theirs(HintSampler):
        def sample(self, normal: Tensor, mask: Tensor, rng: Generator) -> Tensor:
            raise KeyError("density")

    monkeypatch.setattr(
        "normalgan.cli.training.command.run",
        lambda _: draw_hints(Theirs(), zeros(1, 3, 2, 2), zeros(1, 1, 2, 2), 0),
    )
    assert main(["fit"]) == 1
    said = capsys.readouterr().err
    assert said.startswith(
        "normalgan: failed while running: KeyError: 'density' in Theirs.sample (set NORMAL"
    )


@pytest.mark.parametrize(("code", "given"), [(0, "0"), (None, ""), ("too dark", "'too dark'")])
def test_sys_exit_in_somebody_elses_code_is_a_failure_told_with_its_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, code: int | str | None, given: str
) -> None:
    monkeypatch.setattr("normalgan.cli.training.command.NormalGANCLI", lambda *_: sys.exit(code))
    assert main(["fit", "--data.size", "32"]) == 1
    said = capsys.readouterr().err
    assert f"test_main.py, line {sys._getframe().f_lineno - 3}, called sys.exit({given}). Raise an" in said
    assert said.count("\n") == 1


def test_a_traceback_can_be_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(_: list[str]) -> int:
        raise RuntimeError("odd")

    monkeypatch.setattr("normalgan.cli.training.command.run", run)
    monkeypatch.setenv("NORMALGAN_TRACEBACK", "1")
    with pytest.raises(RuntimeError, match="odd"):
        main(["fit"])


def test_it_runs_as_a_module_and_its_code_is_the_exit_code() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "normalgan", "ftt"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("normalgan: no command named")


@pytest.mark.parametrize("command", ["fit", "export x.ckpt -o x.onnx", "benchmark --config embedded.yaml"])
def test_without_the_extra_a_command_that_trains_names_it(command: str) -> None:
    hidden = "; ".join(f"sys.modules[{name!r}] = None" for name in TRAINING_LIBRARIES)
    plans = Path(__file__).parents[1] / "configs" / "benchmark"
    arguments = [word if word != "embedded.yaml" else str(plans / word) for word in command.split()]
    program = f"import sys; {hidden}; from normalgan.__main__ import main; sys.exit(main({arguments}))"
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert ran.stderr.startswith(f"normalgan: {arguments[0]} needs ")
    assert ran.stderr.endswith("pip install 'normalgan[train]'.\n")


def test_without_the_extra_a_drawing_is_predicted(tmp_path: Path) -> None:
    hidden = "; ".join(f"sys.modules[{name!r}] = None" for name in TRAINING_LIBRARIES)
    fox = Path(__file__).parents[1] / "examples" / "sketches" / "fox.png"
    arguments = ["generate", str(fox), "-o", str(tmp_path / "maps")]
    program = f"import sys; {hidden}; from normalgan.__main__ import main; sys.exit(main({arguments}))"
    subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)
    assert (tmp_path / "maps" / "fox_normal.png").exists()


def test_without_the_extra_python_says_what_needs_it(tmp_path: Path) -> None:
    (tmp_path / "mine.ckpt").write_bytes(b"")
    hidden = "; ".join(f"sys.modules[{name!r}] = None" for name in TRAINING_LIBRARIES)
    for call, raised in (
        ("normalgan.load('mine.ckpt')", "InputError: mine.ckpt, which is not an ONNX file, needs torch"),
        ("normalgan.NormalGAN", "ModuleNotFoundError: normalgan.NormalGAN needs torch"),
        ("normalgan.hints", "ModuleNotFoundError: normalgan.hints needs torch"),
    ):
        program = f"import sys; {hidden}; import normalgan; {call}"
        ran = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path
        )
        assert raised in ran.stderr.splitlines()[-1]
        assert ran.stderr.endswith("install it with pip install 'normalgan[train]'.\n")


def test_without_the_extra_several_drawings_are_predicted_on_a_terminal(tmp_path: Path) -> None:
    hidden = "; ".join(f"sys.modules[{name!r}] = None" for name in TRAINING_LIBRARIES)
    sketches = Path(__file__).parents[1] / "examples" / "sketches"
    drawings = [str(sketches / name) for name in ("fox.png", "dog.png")]
    arguments = ["generate", *drawings, "-o", str(tmp_path / "maps")]
    program = f"import sys; {hidden}; from normalgan.__main__ import main; sys.exit(main({arguments}))"
    shown, terminal = pty.openpty()
    said = b""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.DEVNULL, stderr=terminal
    ) as process:
        os.close(terminal)
        with contextlib.suppress(OSError):  # a terminal that nobody writes to any more
            while part := os.read(shown, 2**16):
                said += part
    os.close(shown)
    assert process.returncode == 0, said
    assert b"drawings" in said
    assert len(list((tmp_path / "maps").iterdir())) == 2


def test_the_libraries_of_the_extra_are_those_of_the_project() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = project["project"]["optional-dependencies"]["train"]
    names = {re.split(r"[^\w-]", requirement)[0].replace("-", "_") for requirement in wanted}
    assert names == set(TRAINING_LIBRARIES)
