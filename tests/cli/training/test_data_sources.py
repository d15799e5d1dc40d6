"""Training and testing on pairs from disk, as a user does."""

from pathlib import Path

import pytest
import torch
from command import CONF, Outcome, run

from normalgan.files.shipped_configs import find_config
from pairs_on_disk import hints_picture, write_pairs
from plugin_packages import install
from reported import figures_of

pytestmark = pytest.mark.filterwarnings("ignore:.*LeafSpec.*is deprecated.*")


def on_pairs(command: str, folder: Path, files: object, *arguments: object) -> Outcome:
    return run(
        command,
        *("--config", find_config("paper"), "--config", CONF / "tiny.yaml"),
        *("--data.source", "Pairs", "--data.source.files", files),
        *("--data.cache", folder / "cache", "--trainer.default_root_dir", folder / "run"),
        *arguments,
    )


@pytest.mark.slow  # trains, tests twice and predicts
def test_fit_test_and_predict_on_pairs(tmp_path: Path) -> None:
    pairs = write_pairs(tmp_path / "pairs", 10, "down", 16)
    for number in range(10):
        hints_picture(number).save(pairs / f"a{number}_hints.png")
    done = on_pairs("fit", tmp_path, pairs, "--data.source.green", "down")
    assert done.code == 0, done.err
    assert "left out" not in done.err
    last = tmp_path / "run" / "checkpoints" / "last.ckpt"
    saved = torch.load(last, weights_only=True)["MeshDataModule"]["training_data"]
    assert saved["data.class"] == "PairRecipe"
    tested = on_pairs("test", tmp_path, pairs, "--data.source.green", "down", "--ckpt_path", last)
    assert tested.code == 0, tested.err
    assert "Test split, 2 samples" in tested.out
    plain = figures_of(tmp_path / "run")
    with_hints = on_pairs(
        *("test", tmp_path, pairs, "--data.source.green", "down", "--ckpt_path", last),
        *("--data.source.hints", "true"),
    )
    assert with_hints.code == 0, with_hints.err
    own = figures_of(tmp_path / "run")
    assert plain["no_hints"] == own["no_hints"]
    assert plain["hints"] != own["hints"]
    predicted = on_pairs(
        *("predict", tmp_path, pairs, "--ckpt_path", last, "--data.prediction.sketches", pairs / "a0.png"),
        *("--output.folder", tmp_path / "out"),
    )
    assert predicted.code == 0, predicted.err
    assert (tmp_path / "out" / "a0_normal.png").is_file()


FOREIGN = '''
from dataclasses import dataclass
from normalgan.data.sources import Pair, PairSource
from pairs_on_disk import ellipsoid
@dataclass(frozen=True)
class Shape:
    name: str
    number: int
    def fingerprint(self):
        return f"ellipsoid {self.number}"
    def load(self):
        ink, normal = ellipsoid(self.number)
        return Pair(1 - ink, normal)
@dataclass(frozen=True)
class Ellipsoids(PairSource):
    """Ellipsoids with a wave in them.

    Args:
        count: how many.
    """

    count: int = 10
    def split(self, settings):
        shapes = {f"e{i}": Shape(f"e{i}", i) for i in range(self.count)}
        return {part: [shapes[name] for name in of] for part, of in settings.deal(list(shapes)).items()}
'''


@pytest.mark.slow
def test_a_source_of_somebody_elses_is_named_in_short(tmp_path: Path, site: Path) -> None:
    install(
        site,
        "foreign",
        {"foreign_source": FOREIGN},
        {"normalgan.data_sources": {"E": "foreign_source:Ellipsoids"}},
    )
    folder = tmp_path / "run"
    done = run(
        *("fit", "--config", CONF / "tiny.yaml", "--data.source", "Ellipsoids", "--data.source.count", 8),
        *("--data.cache", tmp_path / "cache", "--trainer.default_root_dir", folder),
        *("--trainer.limit_train_batches", 1),
    )
    assert done.code == 0, done.err
    assert (folder / "checkpoints" / "last.ckpt").is_file()
