"""The tool that trains the weights that ship, in small: from meshes to figures."""

import json
import runpy
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from normalgan.__main__ import main

ROOT = Path(__file__).parents[1]
TOOL: Callable[[list[str]], None] = runpy.run_path(str(ROOT / "tools" / "train_shipped.py"))["main"]


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow
def test_from_meshes_to_figures_and_on_from_where_it_stopped(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[str] = []

    def run_here(command: list[str], check: bool) -> None:
        """Run a command of the tool in this process: each would import for seconds in one of its own."""
        ran.append(command[3])
        assert main(command[3:]) == 0, command

    monkeypatch.setitem(TOOL.__globals__, "subprocess", SimpleNamespace(run=run_here))
    monkeypatch.chdir(ROOT)
    data = {
        "size": 32,
        "renderer": {"class_path": "EmbreeRenderer"},
        "lines": {"class_path": "OccludingContours"},
    }
    shares = {"fractions": [0.6, 0.2, 0.2], "test_views": 2}
    small = {
        "trainer": {"callbacks": [{"class_path": "normalgan.callbacks.WarmAverage"}]},
        "data": {
            **data,
            **shares,
            "groups": [{"meshes": str(meshes), "variants": 1}],
            "extra_animals": 0,
            "train_views": 4,
            "val_views": 1,
            "hand": None,
            "batch_size": 4,
            "cache": str(tmp_path / "cache"),
        },
        "model": {"generator": {"init_args": {"widths": [4, 6], "blocks": [1, 1]}}},
    }
    plan = {
        "name": "solids",
        "images": 4,
        "hint_counts": [0, 5],
        "gallery": 1,
        "rows": [{"name": "inflation", "label": "inflation", "group": "none", "classical": "inflation"}],
        "data": {**data, **shares, "meshes": str(meshes), "cache": str(tmp_path / "cache")},
    }
    for name, content in (("small", small), ("plan", plan)):
        (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(content))
    out = tmp_path / "out"
    arguments = [str(out), "--minutes", "0.05", "--workers", "0"]
    arguments += ["--config", str(tmp_path / "small.yaml"), "--plan", str(tmp_path / "plan.yaml")]
    for _ in range(2):  # the second time all is there but the measuring
        TOOL(arguments)
    assert ran == 2 * ["render", "fit", "export", "export", "benchmark"]
    report = json.loads((out / "figures.json").read_text())
    assert set(report["seconds"]) == {"render", "train", "export", "measure"}
    assert {"plan"} == set(report["figures"])
    assert (out / "ours.onnx").stat().st_size < 100_000
    assert (out / "ours.safetensors").is_file()
