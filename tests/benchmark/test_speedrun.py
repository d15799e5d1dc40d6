"""benchmarks/speedrun.py: when a curve is at the target, and the whole of it at toy size."""

import importlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
TINY = {
    **{"data.size": "32", "data.animals": "3", "data.species": "[quadrupeds]", "data.train_views": "8"},
    **{"data.fractions": "[0.34,0.33,0.33]", "data.val_views": "2", "data.batch_size": "4"},
    **{"data.lines.init_args.resolution": "64", "trainer.max_epochs": "2"},
    **{"model.generator.init_args.widths": "[4,8]", "model.generator.init_args.blocks": "[1,1]"},
}


@pytest.fixture
def speedrun(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    for name in ("machine", "speedrun"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return importlib.import_module("speedrun")


def test_seconds_are_read_between_the_points(speedrun: ModuleType) -> None:
    errors = [None, 30.0, 20.0, 22.0]
    curve = [{"seconds": 10 * i, speedrun.ERROR: error} for i, error in enumerate(errors)]
    found = [speedrun.seconds_to(curve, target) for target in (25.0, 32.0, 20.0, 19.0)]
    assert found == [15, 10, 20, None]


@pytest.mark.slow  # renders and trains
def test_a_curve_of_the_recipe(speedrun: ModuleType, tmp_path: Path) -> None:
    settings = [f"--{name}={value}" for name, value in TINY.items()]
    curve = speedrun.train(settings, tmp_path)
    assert len(curve) == 2
    assert speedrun.seconds_to(curve, 179) == curve[0]["seconds"] > 0
