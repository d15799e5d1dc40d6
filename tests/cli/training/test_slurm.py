"""Under SLURM: a job that is stopped, requeued and started again, and tasks that do not fit."""

import os
import shutil
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from command import Bench
from lightning.pytorch.utilities.exceptions import SIGTERMException

from normalgan.callbacks import StoppedCheckpoint
from normalgan.cli.training.slurm import requeued_on_signal, restarted_from, with_slurm
from normalgan.data.datamodule import MeshDataModule

pytestmark = pytest.mark.skipif(os.name == "nt", reason="SLURM runs on Linux")


@pytest.fixture(autouse=True)
def slurm(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set what srun sets for one task."""
    of_job = {"JOB_ID": "7", "JOB_NAME": "train", "NTASKS": "1", "NTASKS_PER_NODE": "1", "NNODES": "1"}
    of_task = {"PROCID": "0", "LOCALID": "0", "NODEID": "0", "NODELIST": "localhost"}
    for name, value in {**of_job, **of_task}.items():
        monkeypatch.setenv(f"SLURM_{name}", value)


def test_tasks_without_their_number_a_node_are_one_sentence(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SLURM_NTASKS", "2")
    monkeypatch.delenv("SLURM_NTASKS_PER_NODE")
    bench.run("fit", tmp_path).refused("SLURM has 2 tasks", "--ntasks-per-node=2", "SLURM_JOB_NAME=bash")
    monkeypatch.setenv("SLURM_JOB_NAME", "bash")
    assert with_slurm([]) == []


def test_lightning_saves_no_checkpoint_that_it_would_later_prefer() -> None:
    (environment,) = with_slurm([])
    assert not environment.auto_requeue  # type: ignore[attr-defined]


@pytest.mark.parametrize("command", ["fit", "test"])
def test_a_checkpoint_that_lightning_would_prefer_is_named(
    bench: Bench, trained: Path, tmp_path: Path, command: str
) -> None:
    (tmp_path / "hpc_ckpt_1.ckpt").write_bytes(b"unchecked")
    more = ("--ckpt_path", trained / "checkpoints" / "last.ckpt") if command == "test" else ()
    bench.run(command, tmp_path, *more).refused("hpc_ckpt_1.ckpt instead of any other checkpoint")


def test_sigusr1_stops_between_batches_and_requeues_the_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    control = tmp_path / "scontrol"
    control.write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/said\n')
    control.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    saved: list[Path] = []
    trainer: Any = SimpleNamespace(
        world_size=1,
        sanity_checking=False,
        fast_dev_run=False,
        is_global_zero=True,
        validating=False,
        default_root_dir=str(tmp_path),
        save_checkpoint=saved.append,
    )
    module: Any = None
    callback = StoppedCheckpoint()
    callback.on_train_start(trainer, module)
    callback.on_train_batch_start(trainer, module, None, 0)
    os.kill(os.getpid(), signal.SIGUSR1)
    with pytest.raises(SIGTERMException) as stop:
        callback.on_train_batch_start(trainer, module, None, 1)
    callback.on_exception(trainer, module, stop.value)
    assert saved == [tmp_path / "checkpoints" / "stopped.ckpt"]
    assert (tmp_path / "said").read_text() == "requeue 7\n"
    control.write_text('#!/bin/sh\necho "no such job" >&2\nexit 1\n')
    callback.on_exception(trainer, module, stop.value)
    assert "job 7 was not requeued: no such job." in capsys.readouterr().err


def test_a_job_is_requeued_before_training_starts_too(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    control = tmp_path / "scontrol"
    control.write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/said\n')
    control.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")

    def warned(*_: Any, **__: Any) -> None:
        os.kill(os.getpid(), signal.SIGUSR1)

    monkeypatch.setattr(MeshDataModule, "prepare_data", warned)
    before = {each: signal.getsignal(each) for each in (signal.SIGUSR1, signal.SIGINT)}
    outcome = bench.run("fit", tmp_path / "run")
    assert outcome.code == 130
    assert (tmp_path / "said").read_text() == "requeue 7\n"
    assert "job 7 is requeued." in outcome.err
    assert {each: signal.getsignal(each) for each in before} == before
    monkeypatch.setenv("SLURM_PROCID", "1")
    monkeypatch.setenv("SLURM_LOCALID", "1")
    with requeued_on_signal(), pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGUSR1)
    assert (tmp_path / "said").read_text() == "requeue 7\n"


def test_the_newer_checkpoint_continues_a_restarted_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SLURM_RESTART_COUNT", "1")
    assert restarted_from(str(tmp_path)) is None  # it was stopped before its first checkpoint
    (tmp_path / "checkpoints").mkdir()
    for number, name in enumerate(("last", "stopped", "last")):
        path = tmp_path / "checkpoints" / f"{name}.ckpt"
        path.touch()
        os.utime(path, (number, number))
        assert restarted_from(str(tmp_path)) == path
    monkeypatch.delenv("SLURM_RESTART_COUNT")
    assert restarted_from(str(tmp_path)) is None


@pytest.mark.slow
def test_the_same_command_continues_a_restarted_job(
    bench: Bench, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = tmp_path / "run"
    shutil.copytree(trained, run)
    bench.run("fit", run, "--trainer.max_epochs", 9).refused("holds a run already")
    monkeypatch.setenv("SLURM_RESTART_COUNT", "1")
    outcome = bench.run("fit", run, "--trainer.max_epochs", 9)
    assert outcome.code == 0, outcome.err
    assert "SLURM has started this job again; fit resumes" in outcome.err
