"""The notebooks run, and what is stored in them is of the code that stands there."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
TOOL = ROOT / "tools" / "run_notebooks.py"


def cells(path: Path) -> list[nbformat.NotebookNode]:
    """Return the cells of code."""
    return [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]


def pictures(path: Path) -> int:
    """Return how many pictures are stored."""
    return sum("image/png" in output.get("data", {}) for cell in cells(path) for output in cell.outputs)


def test_there_are_two() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["own_meshes", "samplers"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_stored_run_is_of_this_code(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = runpy.run_path(str(TOOL))["fingerprint"](notebook)
    assert notebook.metadata["normalgan"]["code"] == code, f"run tools/run_notebooks.py notebooks/{path.name}"
    assert [cell.execution_count for cell in cells(path)] == list(range(1, len(cells(path)) + 1))
    assert pictures(path) >= 1
    text = path.read_text(encoding="utf-8")
    assert "site-packages" not in text
    assert str(ROOT) not in text
    assert len(text) < 400_000


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow  # trains
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(TOOL), str(path), "-o", str(tmp_path)],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert pictures(tmp_path / path.name) == pictures(path)
