"""SIGTERM where several processes train: the handler sends nothing, and all stop at one batch."""

import os
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks import StoppedCheckpoint
from small import QUIET, gan, trainer
from spheres import loader

MODULE = cast(LightningModule, None)


@pytest.fixture(autouse=True)
def survives_the_signal(signal_handlers_end_with_the_test: None) -> None:
    signal.signal(signal.SIGTERM, lambda *_: None)


def process(asked: list[bool], processes: int = 2) -> Trainer:
    """One of several processes; what each was asked is in a list that they share."""

    def any_of_them(decision: bool, all: bool) -> bool:
        assert not all
        asked.append(decision)
        return any(asked)

    made: Any = SimpleNamespace(
        world_size=processes,
        strategy=SimpleNamespace(reduce_boolean_decision=any_of_them),
        state=SimpleNamespace(fn=TrainerFn.FITTING),
        sanity_checking=False,
    )
    return cast(Trainer, made)


def test_the_handler_sends_nothing_and_all_stop_before_the_same_batch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(torch.distributed, "broadcast", lambda *_, **__: pytest.fail("sent by a handler"))
    asked: list[bool] = []
    one, other, trainer = StoppedCheckpoint(), StoppedCheckpoint(), process(asked)
    one.on_train_start(trainer, MODULE)
    one.on_train_batch_start(trainer, MODULE, None, 0)
    assert asked == [False]
    os.kill(os.getpid(), signal.SIGTERM)
    with pytest.raises(SIGTERMException):
        one.on_train_batch_start(trainer, MODULE, None, 1)
    with pytest.raises(SIGTERMException):  # it got no signal
        other.on_validation_batch_start(trainer, MODULE, None, 1)
    assert asked == [False, True, False]


def test_a_single_process_is_left_to_lightning() -> None:
    before, asked = signal.getsignal(signal.SIGTERM), [True]
    alone, trainer = StoppedCheckpoint(), process(asked, processes=1)
    alone.on_train_start(trainer, MODULE)
    alone.on_train_batch_start(trainer, MODULE, None, 0)
    assert signal.getsignal(signal.SIGTERM) == before
    assert asked == [True]


class Validations(Callback):
    """Notes the epochs that were validated to the end, and stops the run in a validation on request."""

    def __init__(self, stopped_in: int | None = None) -> None:
        self.stopped_in = stopped_in
        self.seen: list[tuple[int, float]] = []

    def on_validation_batch_start(self, trainer: Trainer, *_: object) -> None:
        if trainer.current_epoch == self.stopped_in and self.seen_batches:
            raise SIGTERMException
        self.seen_batches += 1

    def on_validation_start(self, *_: object) -> None:
        self.seen_batches = 0

    def on_validation_end(self, trainer: Trainer, pl_module: LightningModule) -> None:
        self.seen.append((trainer.current_epoch, float(trainer.callback_metrics["val/hints/angular_mean"])))


@pytest.mark.slow
@pytest.mark.filterwarnings(*QUIET)
def test_a_validation_in_which_a_run_was_stopped_is_repeated_when_it_is_resumed(tmp_path: Path) -> None:
    def run(
        folder: str, stopped_in: int | None = None, resumed: Path | None = None
    ) -> list[tuple[int, float]]:
        noted = Validations(stopped_in)
        own = trainer(
            tmp_path / folder, max_epochs=3, num_sanity_val_steps=0, callbacks=[StoppedCheckpoint(), noted]
        )
        path = None if resumed is None else str(resumed)
        try:
            own.fit(gan(), loader(), loader(), ckpt_path=path, weights_only=path is not None)
        except SIGTERMException:
            assert stopped_in is not None
        return noted.seen

    whole = run("whole")
    assert [epoch for epoch, _ in whole] == [0, 1, 2]
    assert run("stopped", stopped_in=1) == whole[:1]
    resumed = run("resumed", resumed=tmp_path / "stopped" / "checkpoints" / "stopped.ckpt")
    assert resumed == whole[1:]
