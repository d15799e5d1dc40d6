"""Results as they are kept in the docs."""

import json
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from normalgan.errors import InputError

TOOLS = Path(__file__).parents[2] / "tools"


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(TOOLS))
    return import_module("keep_results")


def report(row: str, *seeds: int, images: int = 100) -> dict[str, Any]:
    meshes = {"15": {"384": {"angular_mean": 20.123456, "l1": 0.5, "pixels": 7}}}
    runs = [{"row": row, "seed": s, "commit": f"c{s}", "views": [1.0], "meshes": meshes} for s in seeds]
    return {"plan": "p", "images": images, "size": 64, "commit": "c", "seeds": list(seeds), "runs": runs}


def test_rows_that_were_trained_apart_become_one_report(tool: Any) -> None:
    kept = json.loads(tool.rounded(tool.keep([report("paper", 2, 0), report("ours", 0), report("paper", 1)])))
    assert [(run["row"], run["seed"]) for run in kept["runs"]] == [
        *(("paper", seed) for seed in (0, 1, 2)),
        ("ours", 0),
    ]
    assert (kept["seeds"], kept["commits"]) == ([0, 1, 2], ["c0", "c1", "c2"])
    assert kept["runs"][0]["meshes"] == {"15": {"384": {"angular_mean": 20.1235, "l1": 0.5, "pixels": 7}}}
    assert "views" not in kept["runs"][0]


def test_of_figures_by_mesh_some_are_kept(tool: Any) -> None:
    (run,) = tool.keep([report("paper", 0)], ["angular_mean"], ["commit"])["runs"]
    assert run["meshes"]["15"]["384"].keys() == {"angular_mean", "pixels"}
    assert run.keys() == {"row", "seed", "meshes"}


def test_what_was_not_measured_alike_stays_apart(tool: Any) -> None:
    with pytest.raises(InputError, match="the reports differ in images; only such that were measured alike"):
        tool.keep([report("paper", 0), report("ours", 0, images=50)])
    with pytest.raises(InputError, match="two reports have paper with seed 0; leave one of them out"):
        tool.keep([report("paper", 0), report("paper", 0)])
