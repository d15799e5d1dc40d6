import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
import yaml
from command import Bench, left_in, run


def change(source: Path, target: Path, edit: Callable[[dict[str, Any]], object]) -> None:
    checkpoint = torch.load(source, weights_only=True)
    edit(checkpoint)
    torch.save(checkpoint, target)


def plugin_gone(checkpoint: dict[str, Any]) -> None:
    checkpoint["hyper_parameters"]["hint_sampler"]["class_path"] = "gone.Dots"


def plugin_changed(checkpoint: dict[str, Any]) -> None:
    checkpoint["hyper_parameters"]["hint_sampler"]["init_args"]["former"] = 3  # a setting that it had once


# More that is no checkpoint: tests/trust.
BAD: dict[str, tuple[Callable[[Path, Path], object], str]] = {
    "truncated": (lambda good, bad: bad.write_bytes(good.read_bytes()[:-9000]), "damaged or no checkpoint"),
    "plug-in gone": (lambda good, bad: change(good, bad, plugin_gone), "cannot be built here"),
    "plug-in changed": (lambda good, bad: change(good, bad, plugin_changed), "cannot be built here"),
}


@pytest.mark.parametrize(
    ("command", "kind"), [("test", "truncated"), ("fit", "plug-in gone"), ("test", "plug-in changed")]
)
def test_a_bad_checkpoint_is_refused(
    bench: Bench, trained: Path, tmp_path: Path, command: str, kind: str
) -> None:
    make, sentence = BAD[kind]
    bad = tmp_path / "bad.ckpt"
    make(trained / "checkpoints" / "last.ckpt", bad)
    outcome = bench.run(command, tmp_path / "run", "--ckpt_path", bad)
    outcome.refused(str(bad), sentence)
    assert left_in(tmp_path) == ["bad.ckpt"]


def harmful(checkpoint: dict[str, Any]) -> None:
    text = "__import__('pathlib').Path('touched').touch()"  # which sympy runs
    function = {"class_path": "sympy.Lambda", "init_args": {"signature": "x", "expr": text}}
    checkpoint["hyper_parameters"]["lr_scheduler"] = {
        "class_path": "torch.optim.lr_scheduler.LambdaLR",
        "init_args": {"lr_lambda": function},
    }


def test_a_checkpoint_runs_nothing(
    bench: Bench, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bad = tmp_path / "bad.ckpt"
    change(trained / "checkpoints" / "last.ckpt", bad, harmful)
    monkeypatch.chdir(tmp_path)
    resumed = bench.run("fit", tmp_path / "run", "--ckpt_path", bad)
    resumed.refused(str(bad), "lr_lambda of torch.optim.lr_scheduler.LambdaLR is a dict")
    # What only training needs is not looked at by those that paint.
    assert bench.run("test", tmp_path / "run", "--ckpt_path", bad).code == 0
    assert not (tmp_path / "touched").exists()
    assert not (bench.meshes.parent / "touched").exists()


@pytest.mark.slow
def test_a_checkpoint_that_is_missing(bench: Bench, tmp_path: Path) -> None:
    bench.run("test", tmp_path, "--ckpt_path", "gone.ckpt").refused(
        "there is no model gone.ckpt; ", "last, best, shipped."
    )
    bench.run("test", tmp_path, "--ckpt_path", "last").refused("there is no model", "last.ckpt")
    bench.run("test", tmp_path, "--ckpt_path", "lats").refused("no model lats; ", "Did you mean last?")
    run("export", "shippd", "-o", "m.onnx").refused("no model shippd; ", "Did you mean shipped?")
    for command in ("validate", "test"):
        bench.run(command, tmp_path).refused(f"{command} needs a trained model; pass --ckpt_path")


@pytest.mark.filterwarnings("default")
def test_the_checkpoint_wins_and_names_the_ignored_settings(
    bench: Bench, trained: Path, tmp_path: Path
) -> None:
    run = tmp_path / "run"
    shutil.copytree(trained, run)
    outcome = bench.run(
        "fit",
        run,
        *("--ckpt_path", "last", "--trainer.max_epochs", 9, "--trainer.enable_model_summary", "false"),
        *(
            "--model.generator.width",
            8,
            "--model.objective",
            "CrossEntropy",
            "--model.reconstruction.l1_weight",
            7,
        ),
        *("--model.hint_sampler.dropout", 0.5),
    )
    assert outcome.code == 0, outcome.err
    assert outcome.err == (
        f"normalgan: warning: {run}/checkpoints/last.ckpt was trained with other settings, which are kept: "
        "model.generator.width, model.hint_sampler.dropout, model.objective, "
        "model.reconstruction.l1_weight.\n"
    )
    first, second = (
        torch.load(folder / "checkpoints" / "last.ckpt", weights_only=True) for folder in (trained, run)
    )
    assert second["hyper_parameters"] == first["hyper_parameters"]
    assert second["epoch"] == first["epoch"] + 1


def test_settings_left_at_their_defaults_are_not_warned_of(
    bench: Bench, trained: Path, tmp_path: Path
) -> None:
    # Neither the width of 64 nor anything else is asked for here: no one is to be told that it is not so.
    outcome = bench.run(
        "validate",
        tmp_path,
        *("--ckpt_path", trained / "checkpoints" / "last.ckpt"),
        *("--model.generator", "UNetGenerator", "--model.discriminator", "UNetDiscriminator"),
    )
    assert outcome.code == 0, outcome.err
    assert outcome.err == ""


def test_a_finished_run_is_not_overwritten(bench: Bench, trained: Path) -> None:
    before = left_in(trained)
    bench.run("fit", trained).refused("holds a run already: resume it with --ckpt_path")
    assert left_in(trained) == before


@pytest.mark.parametrize("way", ["dirpath", "filename"])
def test_no_callback_writes_over_another_run(bench: Bench, trained: Path, tmp_path: Path, way: str) -> None:
    other = trained / "checkpoints"
    settings = {"dirpath": str(other), "filename": "last", "enable_version_counter": False}
    callback = {"class_path": "lightning.pytorch.callbacks.ModelCheckpoint", "init_args": settings}
    content = {
        "dirpath": {"trainer": {"callbacks": [callback]}},
        "filename": {
            "checkpoint": {"filename": os.path.relpath(other / "last", tmp_path / "run" / "checkpoints")}
        },
    }[way]
    (tmp_path / "theirs.yaml").write_text(yaml.safe_dump(content))
    before = left_in(trained)
    outcome = bench.run("fit", tmp_path / "run", "--config", tmp_path / "theirs.yaml")
    outcome.refused(f"{other.resolve()} holds checkpoints of another run, such as 0")
    assert left_in(trained) == before
    assert not (tmp_path / "run").exists()


def test_a_run_is_not_resumed_over_another(bench: Bench, trained: Path, tmp_path: Path) -> None:
    shutil.copytree(trained / "checkpoints", tmp_path / "run" / "checkpoints")
    shutil.copytree(trained / "checkpoints", tmp_path / "other" / "checkpoints")
    before = left_in(tmp_path / "other")
    given = ("--ckpt_path", tmp_path / "run" / "checkpoints" / "last.ckpt")
    bench.run("fit", tmp_path / "other", *given).refused("other/checkpoints holds a run already")
    assert left_in(tmp_path / "other") == before


def test_fit_does_not_resume_without_the_states_of_the_optimisers(
    bench: Bench, trained: Path, tmp_path: Path
) -> None:
    bad = tmp_path / "bad.ckpt"
    change(trained / "checkpoints" / "last.ckpt", bad, lambda saved: saved.update(optimizer_states=[]))
    bench.run("fit", tmp_path / "run", "--ckpt_path", bad).refused("its optimizer_states is not what")
    assert left_in(tmp_path) == ["bad.ckpt"]
