"""The whole command, on three animals of 32 pixels."""

import json
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import psutil
import pytest
import yaml

from normalgan.__main__ import main
from normalgan.benchmark.evaluation import Evaluation
from normalgan.benchmark.plan import read_plan
from normalgan.benchmark.runs import plan_runs
from normalgan.benchmark.scale import read_scale
from normalgan.data.datamodule import MeshDataModule

ROOT = Path(__file__).parents[2]

PLAN: dict[str, Any] = {
    "name": "Tiny",
    "images": 8,
    "seeds": [0],
    "hints": 5,
    "hint_counts": [0, 20],
    "gallery": 2,
    "placements": ["uniform", "curvature", "farthest", "worst"],
    "placement_counts": [3],
    "noise_degrees": [10],
    "noise_pixels": [2],
    "pins": 2,
    "data": {
        "size": 32,
        "animals": {"count": 3},
        "split": {"fractions": [0.34, 0.33, 0.33]},
        "train_views": 4,
        "val_views": 2,
        "test_views": 3,
        "storage": {"render_workers": 0},
        "lines": {"class_path": "OccludingContours", "init_args": {"resolution": 64}},
        "renderer": {"class_path": "EmbreeRenderer"},
    },
    "rows": [
        {"name": "inflation", "label": "inflation", "classical": "inflation"},
        {"name": "broken", "label": "broken", "configs": [str(ROOT / "configs" / "paper.yaml")]},
        {
            "name": "worst",
            "label": "worst",
            "configs": [str(ROOT / "configs" / "paper.yaml")],
            "changes": {
                "model.hint_sampler": {"class_path": "WorstErrorHints", "init_args": {"count": 3}},
                "model.share_every": 1,
            },
        },
        {"name": "pix2pix", "label": "pix2pix", "configs": [str(ROOT / "configs" / "pix2pix.yaml")]},
    ],
}
# A depth that a network of 32 pixels does not have is found out only when it is built.
PLAN["rows"][1]["settings"] = {"model.generator.init_args.depth": 9}
OVERLAY = {
    "trainer": {"accelerator": "cpu"},
    "data": {"batch_size": 4},
    "model": {
        "generator": {"init_args": {"width": 4}},
        "discriminator": {"init_args": {"width": 4}},
        "n_critic": 1,
    },
}


def figures(printed: str, heading: str) -> list[str]:
    (table,) = (part for part in printed.split("\n## ") if part.startswith(heading))
    return re.findall(r"\d+\.\d+", table.strip().splitlines()[-1])


@pytest.mark.slow  # renders and measures
def test_the_mean_of_the_training_maps_comes_first_on_a_fresh_cache(
    tmp_path: Path, meshes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It needs the training split, which nobody had rendered; the second try worked."""
    row = {"name": "mean", "label": "mean", "classical": "mean"}
    small = {"placements": [], "placement_counts": [], "noise_degrees": [], "noise_pixels": [], "pins": 0}
    plan = tmp_path / "plan.yaml"
    plan.write_text(yaml.safe_dump({**PLAN, **small, "rows": [row]}), encoding="utf-8")
    given = ["benchmark", "--config", str(plan), "-o", str(tmp_path / "out")]
    data = (f"data.cache={tmp_path / 'cache'}", f"data.meshes={meshes}")
    assert main([*given, "--set", *data]) == 0, capsys.readouterr().out
    (result,) = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["runs"]
    assert result["row"] == "mean"


def test_a_plan_that_trains_nothing_renders_the_test_split_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tracks are such plans: for one row of five seconds all training views would be rendered."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "plan.yaml"
    path.write_text(yaml.safe_dump({**PLAN, "rows": PLAN["rows"][:1]}), encoding="utf-8")
    plan, scale = read_plan(path), read_scale([])
    rendered: list[set[str]] = []
    monkeypatch.setattr(MeshDataModule, "render", lambda data, **how: rendered.append({*data.kept}))
    assert Evaluation(plan, scale).data.of_pairs is False
    assert rendered == [{"test"}]


@pytest.mark.slow  # trains thrice in other processes, which import lightning
def test_from_a_plan_to_a_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan, overlay, out = tmp_path / "plan.yaml", tmp_path / "tiny.yaml", tmp_path / "out"
    plan.write_text(yaml.safe_dump(PLAN), encoding="utf-8")
    overlay.write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    given = ["benchmark", "--config", str(plan), "--config", str(overlay), "-o", str(out)]
    given += ["--set", f"data.cache={tmp_path / 'cache'}"]

    assert main(given) == 1  # one run cannot be trained, and the others are
    said = capsys.readouterr().out
    assert "broken, seed 0 failed: its training ended with code 2: normalgan: " in said
    results = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert (results["plan"], results["scale"], results["size"], results["seeds"]) == ("Tiny", "tiny", 32, [0])
    assert str(tmp_path) not in json.dumps(results)
    by_row = {run["row"]: run for run in results["runs"]}
    assert by_row.keys() == {"inflation", "pix2pix", "worst"}
    placed = {f"{name}-3" for name in ("uniform", "curvature", "farthest", "worst")}
    asked = {"0", "5", "20", "own", *placed, "degrees-10", "pixels-2"}
    for run in by_row.values():
        assert run["figures"].keys() == run["meshes"].keys() == asked
    assert by_row["worst"]["figures"]["own"] == {**by_row["worst"]["figures"]["worst-3"], "hints": 3}
    assert {name: len(curve) for name, curve in by_row["worst"]["pins"].items()} == {
        "worst": 3,
        "suggested": 3,
    }
    assert all(0 < record["train/adversarial_share"] < 1 for record in by_row["worst"]["curve"])
    assert by_row["pix2pix"]["images"] == 8
    assert [record["images"] for record in by_row["pix2pix"]["curve"]] == [4, 8]
    assert by_row["inflation"]["figures"]["0"]["angular_mean"] < 45  # of an animal a silhouette tells much
    assert {p.name for p in out.iterdir() if p.is_file()} == {
        *("results.json", "table.md", "curves.png", "gallery.png")
    }

    written = (out / "pix2pix" / "seed0" / "result.json").stat().st_mtime_ns
    assert main([*given, "--rows", "inflation,pix2pix,worst"]) == 0
    assert "pix2pix, seed 0: done already" in capsys.readouterr().out
    assert (out / "pix2pix" / "seed0" / "result.json").stat().st_mtime_ns == written

    (checkpoint,) = (out / "pix2pix" / "seed0" / "checkpoints").glob("0*.ckpt")
    shutil.copy(checkpoint, tmp_path / "model.ckpt")
    weights = tmp_path / "model.safetensors"
    assert main(["export", str(checkpoint), "-o", str(weights)]) == 0
    table = (out / "table.md").read_text(encoding="utf-8")
    for model in (tmp_path / "model.ckpt", weights):
        capsys.readouterr()
        # In a cache of its own: only the test views are rendered.
        assert main([*given, "--set", f"data.cache={tmp_path / 'alone'}", "--evaluate", str(model)]) == 0
        written_too = json.loads((out / "evaluation.json").read_text(encoding="utf-8"))
        assert written_too["meshes"] == by_row["pix2pix"]["meshes"]
        printed = capsys.readouterr().out
        for heading in ("Table 1: 5 hints", "Table 1, without hints", "Table 2", "Mean angular error"):
            assert figures(printed, heading) == figures(table, heading)
    (rendered,) = (tmp_path / "alone").glob("*/dataset.json")
    assert json.loads(rendered.read_text(encoding="utf-8"))["splits"].keys() == {"test"}

    assert main([*given, "--set", "data.test_views=4"]) == 2
    assert "was made with other settings (data.test_views)" in capsys.readouterr().err


def test_mistakes_are_told_before_anything_starts(capsys: pytest.CaptureFixture[str]) -> None:
    fourlegs = str(ROOT / "configs" / "benchmark" / "fourlegs.yaml")
    cpu = str(ROOT / "configs" / "cpu.yaml")
    for arguments, said in (
        ([], "such as configs/benchmark/fourlegs.yaml, but was given no --config."),
        (["--config", cpu], "but was given only overlays."),
        (["--config", fourlegs, "--config", fourlegs], f"but was given {fourlegs}, {fourlegs}."),
        (["--config", fourlegs, "--rows", "paper,their"], "the plan has no row their"),
        (["--config", fourlegs, "--budget", "soon"], "the budget 'soon' is not a duration"),
        (["--config", fourlegs, "--seeds", "1.5"], "--seeds, item 1: expected a whole number, not 1.5."),
        (["--config", fourlegs, "--cheat", "1"], "there is no option --cheat"),
    ):
        assert main(["benchmark", *arguments]) == 2
        error = capsys.readouterr().err
        assert error.startswith("normalgan: ")
        assert said in error


@pytest.mark.slow  # imports lightning and parses the settings of every row
@pytest.mark.parametrize("overlay", ["cpu", "gpu"])
def test_every_row_of_our_plan_can_be_put_together(
    overlay: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    plan = read_plan("configs/benchmark/embedded.yaml")
    runs = plan_runs(plan, read_scale([f"configs/{overlay}.yaml"]), tmp_path, [0])
    assert [run.row.name for run in runs] == [row.name for row in plan.rows]
    assert len({run.hash for run in runs}) == len(runs)
    for run in runs[3:]:
        model, data = run.settings["model"], run.settings["data"]
        n_critic = model["n_critic"] if model["discriminator"] else 1
        seen = (
            run.settings["trainer"]["max_epochs"] * 2100 // data["batch_size"] * data["batch_size"] / n_critic
        )
        assert seen == pytest.approx(plan.images, rel=0.03)
        assert data["size"] == {"cpu": 128, "gpu": 256}[overlay]


@pytest.mark.slow  # trains twice in other processes, which import lightning
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_a_benchmark_that_is_killed_leaves_no_process_and_can_be_repeated(tmp_path: Path) -> None:
    plan, overlay, out = tmp_path / "plan.yaml", tmp_path / "tiny.yaml", tmp_path / "out"
    rows = [row for row in PLAN["rows"] if row["name"] in {"inflation", "pix2pix"}]
    plan.write_text(yaml.safe_dump({**PLAN, "rows": rows}), encoding="utf-8")
    overlay.write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "normalgan",
        "benchmark",
        "--config",
        str(plan),
        "--config",
        str(overlay),
    ]
    command += ["-o", str(out), "--set", f"data.cache={tmp_path / 'cache'}"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not (out / "pix2pix" / "seed0" / ".running").is_file():
        assert process.poll() is None
        time.sleep(0.01)
    children = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait(60)
    assert psutil.wait_procs(children, 60)[1] == []
    for path in out.rglob("*.json"):
        json.loads(path.read_text(encoding="utf-8"))
    subprocess.run(command, check=True, capture_output=True)
    results = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert {run["row"] for run in results["runs"]} == {"inflation", "pix2pix"}
