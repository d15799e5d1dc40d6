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
