from pathlib import Path

import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer

from normalgan.callbacks import WarmAverage
from normalgan.errors import InputError
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)


class Diary(Callback):
    """Notes the weights after each step."""

    def __init__(self) -> None:
        self.pages: list[dict[str, torch.Tensor]] = []

    def on_train_batch_end(self, trainer: Trainer, pl_module: LightningModule, *_: object) -> None:
        self.pages.append({name: p.detach().clone().double() for name, p in pl_module.named_parameters()})


def test_the_saved_weights_are_the_average_by_hand(meshes: Path, cache: Path, tmp_path: Path) -> None:
    diary, decay = Diary(), 0.3  # reached at the third step
    model = gan()
    trainer(tmp_path, max_epochs=2, callbacks=[diary, WarmAverage(decay)]).fit(model, data(meshes, cache))
    average = diary.pages[0]
    assert len(diary.pages) == 6
    for n, page in enumerate(diary.pages[1:], start=1):
        share = min(decay, (1 + n) / (10 + n))
        average = {name: share * average[name] + (1 - share) * page[name] for name in page}
    for name, weights in model.named_parameters():
        torch.testing.assert_close(weights.double(), average[name], rtol=1e-4, atol=1e-6)
    last = diary.pages[-1]
    assert any(not torch.equal(weights.double(), last[name]) for name, weights in model.named_parameters())


@pytest.mark.parametrize("decay", [-0.1, 1.0, float("nan")])
def test_a_decay_that_forgets_nothing_is_refused(decay: float) -> None:
    with pytest.raises(InputError, match=r"WarmAverage was given decay=.*; use a share"):
        WarmAverage(decay)
