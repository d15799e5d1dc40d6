"""The figures on the benchmark's page are those of the results beside it."""

import json
from importlib import import_module
from pathlib import Path
from statistics import fmean

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


INTERVALS = (
    ("benchmark_64", "paper", ("pix2pix", "sketch2normal", "ours")),
    ("placement_64", "paper-uniform-17", ("paper-curvature-17", "paper-farthest-17", "paper-worst-17")),
    ("placement_64", "paper-uniform-3", ("paper-curvature-3",)),
    ("placement_64", "paper-uniform-60", ("paper-curvature-60",)),
    ("ablation_64", "ours", ()),
    ("critic_64", "none", ()),
    *((name, "paper", ("ours",)) for name in ("lines_64", "hand_25_64", "hand_50_64", "hand_100_64")),
    ("folds_64", "paper", ("ours",)),
)
"""Results, the row that others are set beside, and these; all others, if none is named."""


@pytest.mark.parametrize(("name", "beside", "rows"), INTERVALS)
def test_the_page_shows_the_intervals_of_what_was_measured(
    name: str, beside: str, rows: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    results = json.loads((ROOT / "docs" / "results" / f"{name}.json").read_text(encoding="utf-8"))
    labels = {run["row"]: run["label"] for run in results["runs"]}
    lines = [
        line.strip("| ").split(" | ")
        for line in import_module("benchmark_rows").differences(results, beside)
        if line.startswith("| ")
    ]
    others = rows or [row for row in labels if row != beside]
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    for row in others:  # labels may be longer or shorter there
        over_meshes, over_both = (line for line in lines if line[0] == labels[row])
        for meshes, both in zip(over_meshes[2:], over_both[1:], strict=True):
            assert f"{meshes} ({both.partition('[')[2].rstrip(']')})" in page, row


def test_the_page_shows_what_a_critic_does_to_the_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    results = json.loads((ROOT / "docs" / "results" / "critic_64.json").read_text(encoding="utf-8"))
    clipped, penalty = import_module("benchmark_rows").relief(results)[3:5]
    page = " ".join((ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8").split())
    shown = [*clipped.strip("| ").split(" | ")[1:], penalty.split(" | ")[1]]
    missing = [cell for cell in shown if cell not in page and cell.removeprefix("+") not in page]
    assert not missing, "the page lacks:\n" + "\n".join(missing)


@pytest.mark.parametrize("name", ["lines_64", "hand_25_64", "hand_50_64", "hand_100_64"])
def test_the_page_shows_what_another_drawing_costs(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    here, trained = (
        json.loads((ROOT / "docs" / "results" / f"{one}.json").read_text(encoding="utf-8"))
        for one in (name, "ablation_64")
    )
    paper, ours = import_module("benchmark_rows").other_test(here, trained)[-2:]
    cells = [line.strip("| ").split(" | ")[1:3] for line in (paper, ours)]
    assert f" | {' | '.join([*cells[0], *cells[1]])} |" in (ROOT / "docs" / "benchmark.md").read_text()


def test_what_was_tested_on_other_drawings_are_the_networks_that_were_taken_apart() -> None:
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


def test_the_page_shows_what_hints_that_are_off_cost() -> None:
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    given = ("15", *(f"degrees-{n}" for n in (5, 10, 15, 30)), *(f"pixels-{n}" for n in (1, 2, 3, 6)), "0")
    rows: dict[str, list[dict[str, float]]] = {}
    for run in json.loads((ROOT / "docs" / "results" / "users_64.json").read_text(encoding="utf-8"))["runs"]:
        rows.setdefault(run["label"], []).append({one: run["figures"][one]["angular_mean"] for one in given})
    assert len(rows) == 3
    for label, runs in rows.items():
        cells = [f"{fmean(run[one] for run in runs):.2f}°" for one in given]
        assert f"| {label} | {' | '.join(cells)} |" in page


def test_the_page_shows_what_hints_that_are_off_cost_with_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    rows = import_module("benchmark_rows")
    page = " ".join((ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8").split())
    results = json.loads((ROOT / "docs" / "results" / "users_64.json").read_text(encoding="utf-8"))
    runs = [run for run in results["runs"] if run["row"] != "paper"]
    lines = rows.hints({**results, "runs": runs}, "15")
    cells = [
        line.strip("| ").split(" | ")[-1]
        for line in lines
        if line.startswith(("| degrees-15 ", "| pixels-3 "))
    ]
    assert len(cells) == 4
    assert not [cell for cell in cells if cell not in page]


def test_the_page_shows_on_how_many_meshes_ours_is_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    results = json.loads((ROOT / "docs" / "results" / "folds_64.json").read_text(encoding="utf-8"))
    found = import_module("benchmark_rows").meshes(results)[-1]
    assert found == "| ours | -4.0 to -0.8° | 60 of 60 | -6.4 to -2.9° | 60 of 60 |"
    page = " ".join((ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8").split())
    assert "ahead on each of the 20 meshes, with each of the three seeds**: by 0.8 to 4.0°" in page


def test_the_page_shows_all_that_the_speedrun_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    speedrun = import_module("speedrun")
    lines = speedrun.load_log(speedrun.LOG)
    expected = speedrun.rows(lines, lines[-1]["track"], "one core, AVX512")
    page = (ROOT / "docs" / "benchmark.md").read_text(encoding="utf-8")
    missing = [row for row in expected if row not in page]
    assert not missing, "the page lacks:\n" + "\n".join(missing)
