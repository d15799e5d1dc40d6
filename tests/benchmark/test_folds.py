"""Folds of the FourLegs, and their results joined."""

import json
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from normalgan.benchmark.intervals import mesh_interval
from normalgan.errors import InputError

ROOT = Path(__file__).parents[2]
MESHES = {str(number) for number in range(381, 401)}


def test_each_mesh_is_tested_on_once_and_never_trained_on_then(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    made = import_module("make_folds").folds()
    files = [
        json.loads((ROOT / "configs" / "fourleg" / "folds" / f"{k}.json").read_text(encoding="utf-8"))
        for k in range(5)
    ]
    assert files == made
    assert sorted(mesh for fold in files for mesh in fold["test"]) == sorted(MESHES)
    for fold in files:
        assert [len(fold[part]) for part in ("train", "val", "test")] == [14, 2, 4]
        assert {mesh for part in fold.values() for mesh in part} == MESHES


def a_fold(first: int, rows: tuple[str, ...] = ("paper",), views: str = "v") -> dict[str, Any]:
    meshes = {str(first + i): {"angular_mean": 10.0 + first + i, "pixels": 5 + 3 * i} for i in range(2)}
    given = dict.fromkeys(("0", "15", "50", "own"), meshes)
    runs = [
        {"row": row, "label": row, "seed": 0, "meshes": given, "figures": {"own": {"hints": first}}}
        for row in rows
    ]
    return {"specification": {"views": views, "meshes": str(first)}, "runs": runs}


def test_results_of_folds_are_joined_mesh_by_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    tool = import_module("join_folds")
    join = tool.join
    folds = [a_fold(0, ("paper", "ours")), a_fold(2)]
    joined = join(folds)
    assert joined.keys() == {"paper"}  # the other row lacks a fold
    found = mesh_interval(joined["paper"], "0", "angular_mean")
    assert found is not None
    assert found.value == pytest.approx((5 * 10 + 8 * 11 + 5 * 12 + 8 * 13) / 26)
    (run,) = json.loads(tool.report(folds, joined))["runs"]
    assert run["figures"]["15"]["angular_mean"] == pytest.approx(found.value, abs=1e-4)
    with pytest.raises(InputError, match="two folds test on the mesh 1"):
        join([a_fold(0), a_fold(1)])
    with pytest.raises(InputError, match="other views or hints"):
        join([a_fold(0), a_fold(2, views="w")])
