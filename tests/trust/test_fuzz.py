"""The targets of tools/fuzz.py, each over its seeds, in a process with limits; atheris is not needed."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from normalgan.errors import InputError

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
fuzz: Any = import_module("fuzz")
seeds_of: Any = import_module("fuzz_seeds")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")


def test_every_target_has_seeds() -> None:
    assert seeds_of.READERS.keys() == fuzz.TARGETS.keys()


@pytest.mark.slow  # a process each
@pytest.mark.parametrize("target", fuzz.TARGETS)
def test_a_target_finds_nothing_in_its_seeds(tmp_path: Path, target: str) -> None:
    seeds = seeds_of.lay_out_seeds(tmp_path / target, target)
    assert len(seeds) >= 3
    command = [sys.executable, fuzz.__file__, target, *map(str, seeds)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout == f"{len(seeds)} files\n"


def refuse(error: Exception) -> None:
    with fuzz.refusals():
        raise error


def test_a_target_tells_what_it_finds() -> None:
    fuzz.check_svg('<svg><a href="#b"/><image href="data:image/png;base64,AAAA"/></svg>')
    for text in ('<svg><image href="/etc/passwd"/></svg>', f"{'<g>' * 200}{'</g>' * 200}"):
        with pytest.raises(AssertionError):
            fuzz.check_svg(text)
    refuse(InputError("one sentence."))
    with pytest.raises(AssertionError, match="not one sentence"):
        refuse(InputError("two\nlines."))
    with pytest.raises(ValueError, match="other"):
        refuse(ValueError("other"))
