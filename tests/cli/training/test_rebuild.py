from pathlib import Path

import pytest
import torch
from command import Bench
from outsider import GridHints

from normalgan.gan import NormalGAN
from normalgan.models import UNetGenerator


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*LeafSpec.*is deprecated.*")
def test_a_checkpoint_alone_rebuilds_all_a_foreign_sampler_too(bench: Bench, tmp_path: Path) -> None:
    outcome = bench.run(
        "fit", tmp_path, "--model.hint_sampler=outsider.GridHints", "--model.hint_sampler.spacing=4"
    )
    assert outcome.code == 0, outcome.err
    path = tmp_path / "checkpoints" / "last.ckpt"
    gan = NormalGAN.load_from_checkpoint(path, weights_only=True)  # nothing in it is executed
    assert gan.hint_sampler == GridHints(spacing=4)
    assert isinstance(gan.generator, UNetGenerator)
    saved = torch.load(path, weights_only=True)["state_dict"]
    assert all(torch.equal(value, saved[name]) for name, value in gan.state_dict().items())
