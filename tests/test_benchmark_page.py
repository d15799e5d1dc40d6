"""The figures on the benchmark's page are those of the results beside it."""

import json
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("name", ["benchmark_64", "benchmark_128"])
def test_the_page_shows_what_was_measured(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    expected = import_module("benchmark_rows").rows(
        json.loads((ROOT / "docs" / "results" / f"{name}.json").read_text(encoding="utf-8"))
    )
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    missing = [row for row in expected if row not in page]
    assert not missing, "the page lacks:\n" + "\n".join(missing)


@pytest.mark.parametrize("name", ["placement_64", "ablation_64", "critic_64"])
def test_the_page_shows_the_intervals_of_what_was_measured(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    results = json.loads((ROOT / "docs" / "results" / f"{name}.json").read_text(encoding="utf-8"))
    lines = [line for line in import_module("benchmark_rows").differences(results) if line.startswith("| ")]
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    # Labels may be longer or shorter there, and what the first row is beside itself goes without saying.
    methods = len({run["row"] for run in results["runs"]})
    cells = [cell for line in lines[1:methods] for cell in line.strip("| ").split(" | ")[2:]]
    missing = [cell for cell in cells if cell not in page]
    assert not missing, "the page lacks:\n" + "\n".join(missing)
