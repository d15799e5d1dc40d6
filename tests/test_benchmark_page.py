"""The figures on the benchmark's pages are those of the results beside them."""

import json
import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
INTERVAL = re.compile(r"[-+]\d+\.\d+°? \[[-+]\d+\.\d+, [-+]\d+\.\d+\]")
SPREAD = re.compile(r"\d+\.\d+ ± \d+\.\d+°")


def test_the_tables_are_those_of_the_results(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    page = (ROOT / "docs" / "benchmark_tables.md").read_text(encoding="utf-8")
    assert page == import_module("benchmark_tables").page(), "run tools/benchmark_tables.py"


@pytest.mark.parametrize("name", ["README.md", "docs/model_card.md"])
def test_figures_of_the_shipped_weights(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    page = (ROOT / name).read_text(encoding="utf-8")
    tables = import_module("benchmark_tables")
    rows = tables.card(tables.CARDS[name])
    assert "\n".join(rows) in page, "run tools/benchmark_tables.py"


@pytest.mark.parametrize("name", ["README.md", "docs/benchmark.md"])
def test_figures_in_prose_are_in_the_tables(name: str) -> None:
    tables = (ROOT / "docs" / "benchmark_tables.md").read_text(encoding="utf-8")
    page = " ".join((ROOT / name).read_text(encoding="utf-8").split()).replace("**", "")
    found = INTERVAL.findall(page) + SPREAD.findall(page)
    assert found
    assert not [figure for figure in found if figure not in tables]


def test_other_drawings_are_measured_on_the_networks_of_the_ablation() -> None:
    curves = [
        {
            (run["row"], run["seed"]): [
                [epoch[f"val/{given}/angular_mean"] for given in ("hints", "no_hints")]
                for epoch in run["curve"]
            ]
            for run in json.loads((ROOT / "docs" / "results" / f"{name}.json").read_text())["runs"]
        }
        for name in ("lines_64", "ablation_64")
    ]
    assert curves[0].items() <= curves[1].items()
