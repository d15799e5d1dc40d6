"""benchmarks/speedrun.py: what ideas cost beside the last record, and the whole of it at toy size."""

import importlib
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
TINY = [
    *("data.size=32", "data.animals=3", "data.species=[quadrupeds]", "data.fractions=[0.34,0.33,0.33]"),
    *("data.train_views=8", "data.val_views=2", "data.batch_size=4", "data.lines.init_args.resolution=64"),
    *("model.generator.init_args.widths=[4,8]", "model.generator.init_args.blocks=[1,1]"),
    "trainer.max_epochs=3",
]


@pytest.fixture
def speedrun(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    for name in ("machine", "speedrun", "speedrun_cost"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return importlib.import_module("speedrun")


def line(idea: str, seed: int, cost: float | None, device: str = "one core") -> dict[str, Any]:
    curve = [{"cost": 100.0 * i, "images": i, "hints": 30.0 - i, "no_hints": 31.0 - i} for i in range(1, 9)]
    known = {"track": "t", "device": device, "cost_to_target": cost, "curve": curve}
    return {"idea": idea, "set": [], "seed": seed, **known}


def test_costs_and_errors_are_read_between_the_points(speedrun: ModuleType) -> None:
    curve = [{"cost": 10, "hints": None}, {"cost": 20, "hints": 30.0}, {"cost": 40, "hints": 20.0}]
    assert speedrun.cost_to(curve, 25.0) == 30
    assert speedrun.cost_to(curve, 32.0) == 20
    assert speedrun.cost_to(curve, 19.0) is None
    assert speedrun.error_at(curve, 25) == 27.5
    assert speedrun.error_at(curve, 15) is None
    assert speedrun.error_at(curve, 41) is None


def test_a_record_reached_the_target_with_every_seed_on_the_same_kind_of_device(speedrun: ModuleType) -> None:
    lines = [line("a", 0, 300.0), line("a", 1, 500.0), line("b", 0, 350.0), line("b", 1, None)]
    lines += [line("c", 0, 10.0, "a GPU"), {**line("d", 0, 10.0), "track": "other"}]
    record = speedrun.record_of(lines, "t", "one core")
    assert [(one["idea"], one["seed"]) for one in record] == [("a", 0), ("a", 1)]
    assert speedrun.mean_cost(record) == 400
    assert speedrun.record_of(lines[2:], "t", "one core") is None
    said = speedrun.comparison([line("e", 0, 200.0)], record, 20.0)
    assert "e: 3.33 min to 20° (1 seed)" in said
    assert "last record, a: 6.67 min (2 seeds)" in said
    assert "| 800 | 22.00° | 22.00° | +0.00° |" in said
    assert "three seeds of both are to tell" in said


def test_a_row_tells_what_came_of_an_idea(speedrun: ModuleType) -> None:
    lines = [line("a", seed, 500.0) for seed in (0, 1, 2)]
    worse = {**line("b", 0, None), "note": "No gain."}
    worse["curve"] = [{**point, "hints": point["hints"] + 1} for point in worse["curve"][:4]]
    lines += [worse, line("c", 0, 90.0), *(line("d", seed, 390.4) for seed in (0, 1, 2))]
    for one in lines:
        one.setdefault("note", "")
    assert speedrun.rows(lines, "t", "one core") == [
        "| a | 500 | 500 | 500 | **500** |  |  |",
        "| b | not reached |  |  |  | -1.0° at 400 s | No gain. |",
        "| c | 90 |  |  |  | +0.0° at 800 s |  |",  # fewer seeds are no record
        "| d | 390 | 390 | 390 | **390** | +0.0° at 800 s |  |",
    ]
    assert speedrun.gain([line("e", 5, 1.0)], lines[:3]) is None  # no seed in common


@pytest.mark.slow  # renders and trains
def test_an_idea_from_the_command_line_to_the_log(
    speedrun: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    log = tmp_path / "results" / "log.jsonl"
    given = ["--log", str(log), "--runs", str(tmp_path / "runs"), "--target", "179"]
    first = speedrun.parse(["--idea", "first", *given, "--set", *TINY])
    said = speedrun.speedrun(first)
    assert "There is no record yet" in said
    assert said.endswith("A new record.")
    (one,) = map(json.loads, log.read_text(encoding="utf-8").splitlines())
    assert one["record"]
    assert (one["idea"], one["seed"], one["target"]) == ("first", 0, 179)
    assert one["device"].startswith("one core, ")
    assert len(one["curve"]) == 1  # it stopped at the target
    assert one["cost_to_target"] == one["curve"][0]["cost"] > 0
    assert one["curve"][0]["images"] == 8
    assert one["curve"][0]["hints"] < 179
    assert one["curve"][0]["slowdown"] is None or one["curve"][0]["slowdown"] > 0
    assert {"commit", "cpu", "date", "versions"} <= one.keys()

    assert "seed 0" not in speedrun.speedrun(first)  # done already: nothing is trained, nothing logged
    assert len(log.read_text(encoding="utf-8").splitlines()) == 1


def test_what_is_no_setting_is_refused(speedrun: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        speedrun.parse(["--idea", "a", "--set", "data.size"])
    assert "--set was given 'data.size'; write name=value" in capsys.readouterr().err
