from pathlib import Path

import pytest
import torch
from lightning.pytorch import Callback, LightningModule, Trainer
from torch.optim.lr_scheduler import ConstantLR

from normalgan.batch import Batch
from normalgan.callbacks import StableSchedule, WallClockSchedule, rate_schedules
from normalgan.callbacks.rate_schedules import cosine_factor
from normalgan.errors import InputError
from small import QUIET, data, gan, trainer

pytestmark = pytest.mark.filterwarnings(*QUIET)


class Clock(Callback):
    """A clock that goes on by a second with every batch; notes the learning rates of each."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.rates: list[list[float]] = []

    def on_train_batch_end(
        self, trainer: Trainer, pl_module: LightningModule, outputs: object, batch: Batch, batch_idx: int
    ) -> None:
        self.now += 1
        self.rates.append([group["lr"] for o in trainer.optimizers for group in o.param_groups])


@pytest.fixture(name="clock")
def make_clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(rate_schedules, "monotonic", lambda: clock.now)
    return clock


def expected(batches: range, seconds: float, warmup: float) -> list[list[float]]:
    return [[5e-5 * cosine_factor(b / seconds, warmup)] * 2 for b in batches]


def test_the_factor_rises_then_falls_to_nothing() -> None:
    factors = [cosine_factor(i / 1000, 0.05) for i in range(1001)]
    assert factors[0] == 0
    assert factors.index(max(factors)) == 50
    assert max(factors) == 1
    assert factors[:51] == sorted(factors[:51])
    assert factors[50:] == sorted(factors[50:], reverse=True)
    assert factors[-1] == pytest.approx(0, abs=1e-12)
    assert cosine_factor(0, 0) == 1


def test_both_rates_follow_the_clock_until_time_is_up(
    meshes: Path, cache: Path, tmp_path: Path, clock: Clock
) -> None:
    schedule = WallClockSchedule(seconds=10, warmup=0.2)
    # The clock goes first, so that the schedule sees the second that the batch took.
    run = trainer(tmp_path, max_epochs=-1, callbacks=[clock, schedule])
    run.fit(gan(), data(meshes, cache))  # three batches an epoch
    assert len(clock.rates) == 10
    assert clock.rates == [pytest.approx(rates) for rates in expected(range(10), 10, 0.2)]


@pytest.mark.slow
def test_a_resumed_run_has_what_is_left(meshes: Path, cache: Path, tmp_path: Path, clock: Clock) -> None:
    path = tmp_path / "last.ckpt"
    first = trainer(tmp_path, callbacks=[clock, WallClockSchedule(seconds=8, warmup=0.25)])
    first.fit(gan(), data(meshes, cache))
    first.save_checkpoint(path)
    state = torch.load(path, weights_only=False)["callbacks"]["WallClockSchedule"]
    assert state == {"elapsed": 3.0, "rates": [[5e-5], [5e-5]]}
    clock.now += 5000  # a night
    second = trainer(tmp_path, max_epochs=-1, callbacks=[clock, WallClockSchedule(seconds=8, warmup=0.25)])
    second.fit(gan(), data(meshes, cache), ckpt_path=path, weights_only=False)
    assert len(clock.rates) == 8
    assert clock.rates == [pytest.approx(rates) for rates in expected(range(8), 8, 0.25)]


def test_a_second_schedule_is_refused(meshes: Path, cache: Path, tmp_path: Path) -> None:
    model = gan(lr_scheduler=ConstantLR)
    with pytest.raises(InputError, match=r"sets the learning rates itself; set model\.lr_scheduler to null"):
        trainer(tmp_path, callbacks=[WallClockSchedule(10)]).fit(model, data(meshes, cache))


def factors(clock: Clock) -> list[float]:
    """Return what the generator's learning rate was multiplied by in each batch."""
    return [rates[0] / 5e-5 for rates in clock.rates]


@pytest.mark.slow
def test_a_resumed_run_stays_at_the_rate_and_a_cool_down_branches_off(
    meshes: Path, cache: Path, tmp_path: Path
) -> None:
    stable = tmp_path / "stable.ckpt"
    rates = Clock()
    run = trainer(tmp_path, max_epochs=2, callbacks=[rates, StableSchedule(warmup=4)])
    run.fit(gan(), data(meshes, cache))  # three batches an epoch
    run.save_checkpoint(stable)
    assert factors(rates) == pytest.approx([0.25, 0.5, 0.75, 1, 1, 1])

    resumed = Clock()
    run = trainer(tmp_path, max_epochs=3, callbacks=[resumed, StableSchedule(warmup=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=stable)
    assert factors(resumed) == pytest.approx([1, 1, 1])

    cooled, halfway = Clock(), tmp_path / "halfway.ckpt"
    run = trainer(tmp_path, max_epochs=3, callbacks=[cooled, StableSchedule(warmup=4, cooldown=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=stable)
    run.save_checkpoint(halfway)
    assert factors(cooled) == pytest.approx([1, 0.5, 1 - 0.5**0.5])

    rest = Clock()
    run = trainer(tmp_path, max_epochs=-1, callbacks=[rest, StableSchedule(warmup=4, cooldown=4)])
    run.fit(gan(), data(meshes, cache), ckpt_path=halfway)
    assert factors(rest) == pytest.approx([1 - 0.75**0.5])
