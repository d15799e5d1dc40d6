"""The tool that trains the weights that ship, in small: from meshes to figures."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]


@pytest.mark.timeout(900)  # a tool of minutes
@pytest.mark.slow
def test_from_meshes_to_figures_and_on_from_where_it_stopped(meshes: Path, tmp_path: Path) -> None:
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
    command: list[str | Path] = [
        sys.executable,
        "tools/train_shipped.py",
        out,
        "--minutes",
        "0.4",
        "--workers",
        "0",
    ]
    command += ["--config", tmp_path / "small.yaml", "--plan", tmp_path / "plan.yaml"]
    for _ in range(2):  # the second time all is there but the measuring
        done = subprocess.run(
            command, cwd=ROOT, env=dict(os.environ), capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    report = json.loads((out / "figures.json").read_text())
    assert set(report["seconds"]) == {"render", "train", "export", "measure"}
    assert {"plan"} == set(report["figures"])
    assert (out / "ours.onnx").stat().st_size < 100_000
    assert (out / "ours.safetensors").is_file()
