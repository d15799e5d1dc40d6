import json
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch
import yaml

from normalgan.benchmark.plan import Row
from normalgan.benchmark.runs import Run
from normalgan.benchmark.training import fit, measured_checkpoint, read_result, read_state, run_all
from normalgan.errors import InputError, RunError

DATA = {"animals": {"count": 3}, "split": {"fractions": [0.34, 0.33, 0.33]}, "size": 32}


class Bench:
    """Stands for training, measuring and reporting; notes what is asked of it."""

    def __init__(self, *failing: str) -> None:
        self.failing = failing
        self.log: list[str] = []

    def train(self, run: Run) -> None:
        self.log.append(f"train {run.title}")
        if run.row.name in self.failing:
            raise RunError("no luck")

    def evaluate(self, run: Run) -> dict[str, Any]:
        self.log.append(f"evaluate {run.title}")
        return {"row": run.row.name}

    def go(self, runs: list[Run], evaluation: str = "e") -> list[str]:
        self.log.clear()
        return run_all(
            runs, evaluation, self.train, self.evaluate, lambda: self.log.append("report"), lambda text: None
        )


def run(folder: Path, name: str, seed: int = 0, **data: Any) -> Run:
    row = Row(name, name.title(), configs=["c.yaml"])
    return Run(row, seed, folder / name / f"seed{seed}", {"data": {**DATA, **data}, "seed_everything": seed})


def test_finished_runs_are_skipped(tmp_path: Path) -> None:
    bench, runs = Bench(), [run(tmp_path, "a"), run(tmp_path, "a", 1), run(tmp_path, "b")]
    assert bench.go(runs[:2]) == []
    one, two, three = "a, seed 0", "a, seed 1", "b, seed 0"
    assert bench.log == [
        f"train {one}",
        f"evaluate {one}",
        "report",
        f"train {two}",
        f"evaluate {two}",
        "report",
    ]
    assert bench.go(runs) == []
    assert bench.log == [f"train {three}", f"evaluate {three}", "report"]
    assert [read_state(r, "e") for r in runs] == ["done"] * 3


def test_an_interrupted_run_goes_on(tmp_path: Path) -> None:
    one = run(tmp_path, "a")

    class Interrupted(Bench):
        def train(self, run: Run) -> None:
            raise KeyboardInterrupt

    assert read_state(one, "e") == "new"
    with pytest.raises(KeyboardInterrupt):
        Interrupted().go([one])
    assert read_state(one, "e") == "begun"
    bench = Bench()
    bench.go([one])
    assert bench.log == ["train a, seed 0", "evaluate a, seed 0", "report"]


def test_a_failed_run_does_not_stop_the_others(tmp_path: Path) -> None:
    bench, runs = Bench("b"), [run(tmp_path, name) for name in "abc"]
    assert bench.go(runs) == ["b, seed 0 failed: no luck"]
    assert [read_state(r, "e") for r in runs] == ["done", "begun", "done"]
    assert Bench().go(runs) == []
    assert [read_state(r, "e") for r in runs] == ["done"] * 3


def test_an_unexpected_error_does_not_stop_the_other_runs(tmp_path: Path) -> None:
    class Broken(Bench):
        def evaluate(self, run: Run) -> dict[str, Any]:
            raise ZeroDivisionError("by zero\nlong story")

    runs = [run(tmp_path, "a"), run(tmp_path, "b")]
    failures = Broken().go(runs)
    assert failures == [f"{name}, seed 0 failed: ZeroDivisionError: by zero" for name in "ab"]
    assert [read_state(r, "e") for r in runs] == ["trained"] * 2


def test_a_folder_of_other_settings_is_refused(tmp_path: Path) -> None:
    bench = Bench()
    bench.go([run(tmp_path, "a")])
    with pytest.raises(InputError, match=r"seed0 was made with other settings \(data\.size\)"):
        read_state(run(tmp_path, "a", size=64), "e")
    assert read_state(run(tmp_path, "a", cache="elsewhere", storage={"render_workers": 7}), "e") == "done"


def test_other_meshes_are_other_settings(tmp_path: Path) -> None:
    Bench().go([run(tmp_path, "a")])
    with pytest.raises(InputError, match=r"data\.animals\.count, meshes\."):
        read_state(run(tmp_path, "a", animals={"count": 6}), "e")


def test_another_way_to_measure_does_not_train_again(tmp_path: Path) -> None:
    bench, one = Bench(), run(tmp_path, "a")
    bench.go([one])
    assert read_result(one, "e") is not None
    assert read_result(one, "f") is None
    bench.go([one], "f")
    assert bench.log == ["evaluate a, seed 0", "report"]


def test_classical_methods_are_only_measured(tmp_path: Path) -> None:
    classical = replace(run(tmp_path, "a"), row=Row("mean", "Mean", classical="mean"), seed=None)
    classical.settings["model"] = {"changes": "nothing"}
    bench = Bench()
    bench.go([classical])
    assert bench.log == ["evaluate mean", "report"]
    assert "model" not in json.loads((classical.folder / "run.json").read_text())["identity"]


def test_a_damaged_record_is_named(tmp_path: Path) -> None:
    one = run(tmp_path, "a")
    Bench().go([one])
    (one.folder / "run.json").write_text("{")
    with pytest.raises(InputError, match=r"run\.json is damaged"):
        read_state(one, "e")


def test_the_best_checkpoint_or_the_last(tmp_path: Path) -> None:
    one = run(tmp_path, "a")
    with pytest.raises(RunError, match="no checkpoint"):
        measured_checkpoint(one, "best")
    folder = one.folder / "checkpoints"
    folder.mkdir(parents=True)

    def save(best: str) -> None:
        monitored = {"monitor": "val/hints/angular_mean", "best_model_path": best}
        callbacks = {
            "ModelCheckpoint{}": monitored,
            "LastCheckpoint{}": {"monitor": None, "best_model_path": "x"},
        }
        torch.save({"callbacks": callbacks}, folder / "last.ckpt")

    save("")
    assert measured_checkpoint(one, "best").name == "last.ckpt"  # validation never gave a figure
    save("/moved/since/checkpoints/003-20.00.ckpt")
    with pytest.raises(InputError, match=r"003-20\.00\.ckpt, the best checkpoint of its run, is missing"):
        measured_checkpoint(one, "best")
    (folder / "003-20.00.ckpt").touch()
    (folder / "stopped.ckpt").touch()  # later, but not better
    assert measured_checkpoint(one, "best").name == "003-20.00.ckpt"
    assert measured_checkpoint(one, "last").name == "last.ckpt"


@pytest.mark.slow
def test_a_run_that_was_stopped_and_resumed_is_measured_at_its_best(
    meshes: Path, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """End to end: SIGTERM in the second epoch leaves stopped.ckpt, the newest file there is."""
    root = Path(__file__).parents[1]
    settings = yaml.safe_load((root / "conf" / "tiny.yaml").read_text(encoding="utf-8"))
    one = replace(run(tmp_path, "a"), settings=settings)
    settings["trainer"] |= {"default_root_dir": str(one.folder), "max_epochs": 3}
    settings["data"] |= {"meshes": str(meshes), "cache": str(cache)}
    still = {"class_path": "torch.optim.SGD", "init_args": {"lr": 0.0}}  # no epoch is better than the first
    settings["model"]["generator"]["init_args"]["norm"] = "none"  # whose statistics would move all the same
    settings["model"] |= {"generator_optimizer": still, "discriminator_optimizer": still}
    stop = {
        "class_path": "killer.KillAt",
        "init_args": {"epoch": 1, "batch": 0, "number": int(signal.SIGTERM)},
    }
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(root / "cli"), *sys.path]))
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    one.folder.mkdir(parents=True)
    settings["trainer"]["callbacks"] = [stop]
    with pytest.raises(RunError, match=f"code {128 + signal.SIGTERM}"):
        fit(one)
    assert (one.folder / "checkpoints" / "stopped.ckpt").is_file()
    settings["trainer"]["callbacks"] = []
    fit(one)
    assert measured_checkpoint(one, "best").name.startswith("000-")
