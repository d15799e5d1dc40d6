"""SIGTERM where several processes train: the handler sends nothing, and all stop at one batch."""

import os
import signal
from types import SimpleNamespace
from typing import Any, cast

import pytest
import torch
from lightning.pytorch import LightningModule, Trainer
from lightning.pytorch.trainer.states import TrainerFn
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks import StoppedCheckpoint

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
