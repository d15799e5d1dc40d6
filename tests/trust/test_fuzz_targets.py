"""The targets of tools/fuzz, each over its seeds, in a process with limits; atheris is not needed for it."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[2] / "tools" / "fuzz"
TARGETS = sorted(path.stem.removeprefix("fuzz_") for path in TOOL.glob("fuzz_*.py"))
IMPORT_TORCH = {"checkpoint", "configuration", "weights"}
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")


@pytest.fixture(autouse=True)
def modules_of_the_tool(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(TOOL))


def run(target: str, *files: Path) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, str(TOOL / f"fuzz_{target}.py"), *map(str, files)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


def test_every_target_has_seeds() -> None:
    assert sorted(import_module("seeds").READERS) == TARGETS


@pytest.mark.parametrize(
    "target",
    [pytest.param(target, marks=pytest.mark.slow if target in IMPORT_TORCH else ()) for target in TARGETS],
)
def test_a_target_finds_nothing_in_its_seeds(tmp_path: Path, target: str) -> None:
    seeds = import_module("seeds").lay_out_seeds(tmp_path / target, target)
    assert len(seeds) >= 3
    done = run(target, *seeds)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout == f"{len(seeds)} files\n"


def test_a_target_tells_what_it_finds() -> None:
    look_at = import_module("fuzz_svg").look_at
    look_at('<svg><a href="#b"/><image href="data:image/png;base64,AAAA"/></svg>')
    for text in ('<svg><image href="/etc/passwd"/></svg>', f"{'<g>' * 200}{'</g>' * 200}"):
        with pytest.raises(AssertionError):
            look_at(text)
    errors = import_module("normalgan.errors")

    def read(error: Exception) -> None:
        with import_module("harness").refusals():
            raise error

    read(errors.InputError("one sentence."))
    with pytest.raises(AssertionError, match="no sentence"):
        read(errors.InputError("two\nlines."))
    with pytest.raises(ValueError, match="other"):
        read(ValueError("other"))
