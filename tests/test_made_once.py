"""What is costly to make is made by one process of a run, and the others get the same."""

from pathlib import Path

import pytest

from made_once import made_once

SUITE = """
from pathlib import Path
from made_once import made_once

def fill(folder):
    (folder / "made").write_text("whole")
    with Path({log!r}).open("a") as log:
        log.write("made\\n")

def test_it(tmp_path_factory):
    assert (made_once(tmp_path_factory, "costly", fill) / "made").read_text() == "whole"
"""


def test_two_processes_make_it_once(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # they take long to import
    log = tmp_path / "log"
    for number in range(2):
        pytester.makepyfile(**{f"test_{number}": SUITE.format(log=str(log))})
    pytester.runpytest_subprocess("-p", "xdist", "-n2", "--dist=loadfile").assert_outcomes(passed=2)
    assert log.read_text() == "made\n"


def test_where_making_fails_it_is_tried_again(tmp_path_factory: pytest.TempPathFactory) -> None:
    def fail(folder: Path) -> None:
        (folder / "half").touch()
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        made_once(tmp_path_factory, "tried", fail)
    folder = made_once(tmp_path_factory, "tried", lambda folder: (folder / "whole").touch())
    assert [path.name for path in folder.iterdir()] == ["whole"]
