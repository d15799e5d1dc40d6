"""Settings of Lightning that need automatic optimisation are refused in one sentence."""

from pathlib import Path

import pytest
from command import Bench
from lightning.pytorch.tuner.tuning import Tuner

from normalgan.errors import InputError
from small import QUIET, data, gan, trainer


def test_the_finder_of_learning_rates_is_refused(bench: Bench, tmp_path: Path) -> None:
    done = bench.run("fit", tmp_path / "run", "--trainer.callbacks", "LearningRateFinder")
    done.refused("LearningRateFinder cannot be used, because NormalGAN steps its optimisers by hand")


@pytest.mark.filterwarnings(*QUIET)
def test_the_tuner_of_lightning_is_refused(meshes: Path, cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="LearningRateFinder cannot be used"):
        Tuner(trainer(tmp_path)).lr_find(gan(), data(meshes, cache))
