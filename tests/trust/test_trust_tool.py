import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

TOOL = Path(__file__).parents[2] / "tools" / "trust"
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it looks at processes as Linux shows them")
CHANGES = """
import sys
from pathlib import Path
from changes import tell_changes
folder = Path(sys.argv[1])
tell_changes(folder / "in", folder / "told", int(sys.argv[2]), float(sys.argv[3]))
(folder / "out").write_text("not told")
(folder / "in" / "a").write_text("1")
(folder / "in" / "a").rename(folder / "in" / "b")
(folder / "in" / "b").read_text()
(folder / "in" / "b").unlink()
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def modules_of_the_tool(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(TOOL))


@pytest.mark.parametrize(
    ("kill_at", "seconds", "left"),
    [(0, 0.0, []), (1, 0.0, []), (2, 0.0, ["a"]), (3, 0.0, ["b"]), (1, 2.0, [])],
)
def test_a_process_is_killed_before_or_after_a_change(
    tmp_path: Path, kill_at: int, seconds: float, left: list[str]
) -> None:
    (tmp_path / "in").mkdir()
    command = [sys.executable, "-c", CHANGES, str(tmp_path), str(kill_at), str(seconds)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(TOOL)})
    if kill_at:
        assert process.wait(60) == -signal.SIGKILL
    process.communicate()
    assert process.returncode == (-signal.SIGKILL if kill_at else 0)
    assert sorted(path.name for path in (tmp_path / "in").iterdir()) == left
    told = (tmp_path / "told").read_text().splitlines()
    expected = [f"open {tmp_path}/in/a", f"os.rename {tmp_path}/in/a", f"os.remove {tmp_path}/in/b"]
    assert told == expected[: kill_at if kill_at and not seconds else 3]


def test_one_bit_is_flipped(tmp_path: Path) -> None:
    flip = import_module("bits").flip
    path = tmp_path / "file"
    path.write_bytes(bytes(9))
    rng = np.random.default_rng(0)
    bit = flip(path, rng)
    assert int.from_bytes(path.read_bytes(), "little") == 1 << bit
    assert len({flip(path, rng) for _ in range(200)}) > 60


def test_moments_are_within_what_was_measured() -> None:
    moments = import_module("moments")
    fresh, at_any, at_change = moments.FRESH, moments.ANY, moments.CHANGE
    for files in (0, 7):
        draw = moments.Draw(np.random.default_rng(0), fresh=9.0, forked=3.0, changes=5, files=files)
        drawn = [draw.moment(number) for number in range(400)]
        kinds = [kind for kind, _ in drawn]
        assert [kinds.count(kind) for kind in (fresh, at_any, at_change)] == [40, 160, 200]
        assert {m.files for kind, m in drawn if kind == at_change} == set(range(1, 8) if files else [0])
        assert {m.change for kind, m in drawn if kind == at_change} == set([0] if files else range(1, 6))
        assert 2.5 < max(m.seconds for kind, m in drawn if kind == at_any) < 3
        assert 6 < max(m.seconds for kind, m in drawn if kind == fresh) < 9
        late = [draw.moment(number, 0.8)[1] for number in range(0, 400, 2)]
        assert {(m.files, m.change) for m in late} == ({(7, 0)} if files else {(0, 1)})


def test_a_section_is_written_at_each_step_and_the_others_stay(tmp_path: Path) -> None:
    keep = import_module("record").keep
    path = tmp_path / "trust.json"
    path.write_text('{"other": {"kills": 3}}')

    def steps() -> Iterator[dict[str, Any]]:
        yield {"kills": 1, "findings": []}
        half = json.loads(path.read_text())["kills"]
        assert (half["kills"], half["finished"]) == (1, False)
        yield {"kills": 2, "findings": ["a"]}

    assert keep(path, "kills", "command", 4, steps()) == ["a"]
    found = json.loads(path.read_text())
    assert found["other"] == {"kills": 3}
    assert (found["kills"]["kills"], found["kills"]["finished"], found["kills"]["seed"]) == (2, True, 4)
    assert {"command", "commit", "date", "machine", "versions", "seconds"} < found["kills"].keys()


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow
def test_experiments_find_nothing(tmp_path: Path) -> None:
    """All in one process, which imports for ten seconds before the first."""
    path = tmp_path / "trust.json"
    # One mutant for each reader; of two runs with the same seed, and one with the next.
    tried = {
        "kills-fit": ("kills", 2),
        "kills-render": ("kills", 2),
        "mutations": ("mutants", 10),
        "determinism": ("runs", 3),
    }
    command = [sys.executable, str(TOOL), *tried, "--count", "2", "-o", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    sections = json.loads(path.read_text())
    assert sections.keys() == tried.keys()
    for experiment, (what, count) in tried.items():
        section = sections[experiment]
        assert section[what] == count, experiment
        assert (section["finished"], section["findings"]) == (True, [])
