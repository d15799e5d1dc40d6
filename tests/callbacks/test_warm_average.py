from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from torch.utils._python_dispatch import TorchDispatchMode

from normalgan.callbacks import WarmAverage
from normalgan.callbacks.checkpoints import LastCheckpoint
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


class Waits(TorchDispatchMode):
    """Notes operations that wait until a value has come from the device."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]
        self.found: list[str] = []

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        if func.overloadpacket.__name__ in {
            "_local_scalar_dense",
            "_linalg_check_errors",
            "nonzero",
            "equal",
        }:
            self.found.append(str(func))
        return func(*args, **(kwargs or {}))


class Watched(WarmAverage):
    """Notes what its update waits for."""

    def __init__(self) -> None:
        super().__init__()
        self.waits = Waits()

    def on_train_batch_end(self, *given: Any) -> None:
        with self.waits:
            super().on_train_batch_end(*given)


def test_an_update_waits_for_no_value_of_the_device(meshes: Path, cache: Path, tmp_path: Path) -> None:
    watched = Watched()
    model = gan()
    read = model.training_step
    model.training_step = lambda *given: _within(watched.waits, read, given)
    trainer(tmp_path, callbacks=[watched]).fit(model, data(meshes, cache))
    assert watched.waits.found == []


def _within(mode: Waits, function: Callable[..., Any], given: tuple[Any, ...]) -> Any:
    with mode:
        return function(*given)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*exists and is not empty.*")  # it resumes in the same folder
def test_a_resumed_average_goes_on_counting(meshes: Path, cache: Path, tmp_path: Path) -> None:
    """As one of before this: its state in the checkpoint is that of Lightning's callback."""
    whole, first, second = gan(), gan(), gan()
    trainer(tmp_path, max_epochs=2, callbacks=[WarmAverage(0.9)]).fit(whole, data(meshes, cache))

    def saving(epochs: int) -> Trainer:
        callbacks = [WarmAverage(0.9), LastCheckpoint()]
        return trainer(tmp_path, max_epochs=epochs, callbacks=callbacks, enable_checkpointing=True)

    saving(1).fit(first, data(meshes, cache))
    last = tmp_path / "checkpoints" / "last.ckpt"
    saving(2).fit(second, data(meshes, cache), ckpt_path=last, weights_only=False)
    for one, other in zip(whole.parameters(), second.parameters(), strict=True):
        assert torch.equal(one, other)
