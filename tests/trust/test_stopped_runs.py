import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import torch

sys.path.insert(0, str(Path(__file__).parents[1] / "cli"))

from command import CONF, Bench, left_in

from normalgan.errors import InputError
from normalgan.files.run_lock import one_run_in
from normalgan.losses.finite import loss_error, not_finite

MORE = ("--config", CONF / "resume.yaml", "--trainer.max_epochs", 2)


@pytest.fixture(autouse=True)
def callbacks_of_this_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).parent))


def load(path: Path) -> dict[str, Any]:
    checkpoint: dict[str, Any] = torch.load(path, weights_only=True)
    return checkpoint


@pytest.mark.slow  # trains in two processes
def test_a_preempted_run_saves_and_says_where(bench: Bench, tmp_path: Path) -> None:
    stop = ("--trainer.callbacks", "killer.KillAt", "--trainer.callbacks.number", int(signal.SIGTERM))
    when = ("--trainer.callbacks.epoch", 1, "--trainer.callbacks.batch", 1)
    outcome = bench.run("fit", tmp_path / "run", *MORE, *stop, *when)
    last, stopped = (tmp_path / "run" / "checkpoints" / name for name in ("last.ckpt", "stopped.ckpt"))
    outcome.refused("stopped by SIGTERM", f"resume with --ckpt_path {stopped}.", code=143)
    assert load(stopped)["global_step"] > load(last)["global_step"]
    assert not [name for name in left_in(tmp_path) if name.endswith((".tmp", ".running"))]
    bench.run("fit", tmp_path / "run", *MORE).refused("holds a run already")
    for path in (last, stopped):
        resumed = bench.run("fit", tmp_path / "run", *MORE, "--ckpt_path", path)
        assert resumed.code == 0, resumed.err
        assert load(last)["epoch"] == 1


@pytest.mark.slow  # trains in a process
def test_ctrl_c_says_how_to_resume(bench: Bench, tmp_path: Path) -> None:
    stop = ("--trainer.callbacks", "killer.KillAt", "--trainer.callbacks.number", int(signal.SIGINT))
    when = ("--trainer.callbacks.epoch", 1, "--trainer.callbacks.batch", 1)
    outcome = bench.run("fit", tmp_path / "run", *MORE, *stop, *when)
    last = tmp_path / "run" / "checkpoints" / "last.ckpt"
    outcome.refused(f"stopped; resume with --ckpt_path {last}.", code=130)
    assert load(last)["epoch"] == 0


@pytest.mark.slow  # trains in a process
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_ctrl_c_that_python_drops_stops_the_run_too(bench: Bench, tmp_path: Path) -> None:
    stop = (
        "--trainer.callbacks",
        "killer.KillInDestructorAt",
        "--trainer.callbacks.number",
        int(signal.SIGINT),
    )
    when = ("--trainer.callbacks.epoch", 1, "--trainer.callbacks.batch", 1)
    outcome = bench.run("fit", tmp_path / "run", *MORE, *stop, *when)
    last = tmp_path / "run" / "checkpoints" / "last.ckpt"
    outcome.refused(f"stopped; resume with --ckpt_path {last}.", code=130)
    assert load(last)["epoch"] == 0


def test_a_loss_that_is_no_number_stops_the_run(bench: Bench, tmp_path: Path) -> None:
    spoil = ("--trainer.callbacks", "stoppers.SpoilAt", "--trainer.callbacks.epoch", 1)
    batch = ("--trainer.callbacks.batch", 2, "--trainer.callbacks.value", ".inf")
    outcome = bench.run("fit", tmp_path / "run", *MORE, *spoil, *batch)
    stopped = tmp_path / "run" / "checkpoints" / "stopped.ckpt"
    spoilt = next(line for line in outcome.out.splitlines() if line.startswith("spoilt")).split()[1:]
    outcome.refused("is nan", "in epoch 2, batch 3", ", ".join(spoilt), f"are in {stopped}.", code=1)
    for name, weights in load(stopped)["state_dict"].items():
        # The running statistics of batch norm are taken when the batch passes, before there is a loss.
        assert torch.isfinite(weights).all() or ".running_" in name, name
    assert load(tmp_path / "run" / "checkpoints" / "last.ckpt")["epoch"] == 0


def test_only_what_is_not_finite_is_named() -> None:
    losses = {"l1": 1.0, "hints": float("nan"), "adversarial": -float("inf"), "penalty": 3e38}
    bad = not_finite(losses)
    assert bad == ["hints is nan", "adversarial is -inf"]
    said = str(loss_error(bad, [f"horse/{i}" for i in range(10)], 3, 17))
    assert "(hints is nan, adversarial is -inf) in epoch 4, batch 18, with the samples horse/0," in said
    assert "horse/7 and 2 more; lower" in said
    assert "another process" in str(loss_error([], ["a/0"], 0, 0))


HOLD = "import sys\nfrom pathlib import Path\nfrom normalgan.files.run_lock import one_run_in\n" + (
    "with one_run_in(Path(sys.argv[1])):\n    print('held', flush=True)\n    sys.stdin.read()\n"
)


def test_two_runs_do_not_train_in_one_folder(bench: Bench, tmp_path: Path) -> None:
    run = tmp_path / "run"
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(run)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ},
    )
    try:
        assert other.stdout is not None
        assert other.stdout.readline() == "held\n"
        outcome = bench.run("fit", run)
        outcome.refused(f"another run trains in {run} now")
        assert left_in(run) == [".running"]
    finally:
        other.kill()
        other.communicate()
    # It was killed: its file is left behind, and stops nobody.
    assert left_in(run) == [".running"]
    with one_run_in(run), pytest.raises(InputError, match="another run trains in"), one_run_in(run):
        pass
    assert left_in(run) == []
