import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import torch
from command import CONF, Bench, left_in


def load(folder: Path) -> dict[str, Any]:
    checkpoint: dict[str, Any] = torch.load(folder / "checkpoints" / "last.ckpt", weights_only=True)
    return checkpoint


def assert_same(a: Any, b: Any, where: str = "") -> None:
    """Compare nested containers of tensors, the tensors to the bit."""
    assert type(a) is type(b), where
    if isinstance(a, torch.Tensor):
        assert torch.equal(a, b), where
    elif isinstance(a, dict):
        assert a.keys() == b.keys(), where
        for key in a:
            assert_same(a[key], b[key], f"{where}.{key}")
    elif isinstance(a, (list, tuple)):
        assert len(a) == len(b), where
        for i, (x, y) in enumerate(zip(a, b, strict=True)):
            assert_same(x, y, f"{where}.{i}")
    else:
        assert a == b, where


@pytest.mark.slow
@pytest.mark.parametrize("every", [1, 2])
def test_a_run_killed_and_resumed_ends_as_an_unbroken_one(bench: Bench, tmp_path: Path, every: int) -> None:
    # Nine samples in batches of two are four batches an epoch; with n_critic 3 the epochs differ.
    # Where every second epoch is validated, Lightning's own checkpoint is saved before the epoch has ended.
    more = ("--config", CONF / "resume.yaml", "--trainer.check_val_every_n_epoch", every)
    unbroken, killed = tmp_path / "unbroken", tmp_path / "killed"
    assert bench.run("fit", unbroken, *more).code == 0
    arguments = (
        *("fit", "--config", CONF / "tiny.yaml", "--data.meshes", bench.meshes, "--data.cache", bench.cache),
        *("--trainer.default_root_dir", killed, *more, "--trainer.callbacks", "killer.KillAt"),
        *("--trainer.callbacks.epoch", 1, "--trainer.callbacks.batch", 1),
    )
    paths = [str(CONF.parent / "cli"), os.environ.get("PYTHONPATH", "")]
    process = subprocess.run(
        [sys.executable, "-m", "normalgan", *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert process.returncode == -signal.SIGKILL, process.stderr
    assert load(killed)["epoch"] == 0  # killed in the next one
    outcome = bench.run("fit", killed, *more, "--ckpt_path", killed / "checkpoints" / "last.ckpt")
    assert outcome.code == 0, outcome.err
    whole, mended = load(unbroken), load(killed)
    assert whole["epoch"] == 3
    for part in ("state_dict", "optimizer_states", "lr_schedulers", "global_step"):
        assert_same(whole[part], mended[part], part)
    assert not [name for name in left_in(killed) if name.endswith(".tmp")]


@pytest.mark.slow  # trains twice
def test_another_seed_ends_otherwise(bench: Bench, tmp_path: Path) -> None:
    # Else the test above would prove nothing.
    more = ("--config", CONF / "resume.yaml", "--trainer.max_epochs", 1)
    ends = []
    for seed in (0, 1):
        folder = tmp_path / str(seed)
        assert bench.run("fit", folder, *more, "--model.seed", seed).code == 0
        ends.append(load(folder)["state_dict"])
    assert any(not torch.equal(ends[0][name], ends[1][name]) for name in ends[0])


def test_a_run_that_has_had_its_epochs_is_told(bench: Bench, trained: Path, tmp_path: Path) -> None:
    copy = tmp_path / "run"
    shutil.copytree(trained, copy)
    resume = ("fit", copy, "--ckpt_path", "last", "--trainer.max_epochs")
    outcome = bench.run(*resume, 8)
    assert outcome.code == 0, outcome.err
    assert "is from epoch 8, and --trainer.max_epochs is 8; pass a larger one to train on." in outcome.out
    bench.run(*resume, 1).refused("is from epoch 8, but --trainer.max_epochs is 1; pass a larger one")
