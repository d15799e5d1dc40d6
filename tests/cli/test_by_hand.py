"""The tuner of Lightning needs automatic optimisation, and is refused in one sentence."""

from pathlib import Path

import pytest
from lightning.pytorch.tuner.tuning import Tuner

from normalgan.errors import InputError
from small import QUIET, data, gan, trainer


@pytest.mark.filterwarnings(*QUIET)
def test_the_tuner_of_lightning_is_refused(meshes: Path, cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="LearningRateFinder cannot be used"):
        Tuner(trainer(tmp_path)).lr_find(gan(), data(meshes, cache))
