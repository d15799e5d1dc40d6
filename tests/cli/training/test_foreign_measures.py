"""A metric and an augmentation of somebody else's: in training, in test's table and in the benchmark."""

import json
from pathlib import Path

import pytest
import torch
import yaml
from command import Bench, run

from plugin_packages import install
from reported import figures_of

pytestmark = pytest.mark.filterwarnings("ignore:.*LeafSpec.*is deprecated.*")

MODULE = '''
from dataclasses import dataclass
import torch
from normalgan.data.augmentation import BatchAugmentation
from normalgan.metrics import MapMetric
@dataclass(frozen=True)
class Fade(BatchAugmentation):
    """Make the lines fainter.

    Args:
        strength: by how much.
    """

    strength: float = 0.5
    def __call__(self, batch, seed):
        return {**batch, "sketch": batch["sketch"] * self.strength}
class ShareFacing(MapMetric):
    """Share of the painted normals that face the viewer by more than so much.

    Args:
        least: n_z from which a normal counts.
    """

    label = "facing"
    unit = "%"
    def __init__(self, least: float = 0.5) -> None:
        super().__init__()
        self.least = least
        for name in ("facing", "count"):
            self.add_state(name, torch.tensor(0), dist_reduce_fx="sum")
    def update(self, preds, target, mask):
        self.facing += ((preds[:, 2:3] > self.least) & (mask > 0.5)).sum()
        self.count += (mask > 0.5).sum()
    def compute(self):
        return self.facing / self.count
'''


@pytest.mark.slow  # trains, tests and compares
def test_a_metric_and_an_augmentation_are_used_by_short_name(
    bench: Bench, tmp_path: Path, site: Path
) -> None:
    entries = {
        "normalgan.metrics": {"S": "foreign_measures:ShareFacing"},
        "normalgan.augmentations": {"F": "foreign_measures:Fade"},
    }
    install(site, "foreign", {"foreign_measures": MODULE}, entries)
    config = tmp_path / "own.yaml"
    metric = {"class_path": "ShareFacing", "init_args": {"least": 0.25}}
    settings = {
        "data": {"augmentation": {"class_path": "Fade", "init_args": {"strength": 0.25}}},
        "report": {"metrics": [metric]},
    }
    config.write_text(yaml.safe_dump(settings))
    folder = tmp_path / "run"
    done = bench.run("fit", folder, "--config", config, "--trainer.limit_train_batches", 1)
    assert (done.code, done.err.count("warning")) == (0, 0), done.err
    last = folder / "checkpoints" / "last.ckpt"
    trained = torch.load(last, weights_only=True)["MeshDataModule"]["training_data"]
    assert trained["data.augmentation"] == {"class": "Fade", "strength": 0.25}
    tested = bench.run("test", folder, "--config", config, "--ckpt_path", last)
    assert tested.code == 0, tested.err
    (row,) = (line.split() for line in tested.out.splitlines() if line.strip().startswith("facing"))
    assert row[:2] == ["facing", "100.0%"]  # of the constant map
    figures = figures_of(folder)
    assert figures["constant"]["share_facing"] == 1
    assert 0 <= figures["hints"]["share_facing"] <= 1
    plan = {
        "name": "Facing",
        "images": 4,
        "metrics": [metric, {"class_path": "ShareBelow", "init_args": {"threshold": 3.0}}],
        "rows": [{"name": "constant", "label": "facing us", "classical": "constant"}],
        "data": {
            **{"meshes": str(bench.meshes), "cache": str(bench.cache), "size": 32, "train_views": 4},
            **{
                "val_views": 2,
                "test_views": 2,
                "storage": {"render_workers": 0},
                "split": {"fractions": [0.6, 0.2, 0.2]},
            },
            "lines": {"class_path": "SuggestiveContours", "init_args": {"resolution": 128}},
        },
    }
    (tmp_path / "plan.yaml").write_text(yaml.safe_dump(plan))
    compared = run("benchmark", "--config", tmp_path / "plan.yaml", "--output", tmp_path / "bench")
    assert compared.code == 0, compared.err
    table = (tmp_path / "bench" / "table.md").read_text()
    heading, _, line = table.split("## Table 1")[1].splitlines()[2:5]
    cells = dict(zip(heading.split("|"), line.split("|"), strict=True))
    assert cells[" facing "] == " 100.0 % "
    assert " below_3 " in cells
    (result,) = json.loads((tmp_path / "bench" / "results.json").read_text())["runs"]
    assert result["figures"]["15"]["share_facing"] == 1
