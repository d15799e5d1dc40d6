"""Trains the shipped weights in a given time, from meshes to measured files; a second call resumes.

train_shipped.py OUT [--minutes 40] [--config OVERLAY.yaml …] [--plan PLAN.yaml …] [--workers N]

It renders on all cores, trains with configs/ours.yaml and configs/shipped.yaml for the remaining time except
the share for measuring (in bfloat16 on a GPU if there is one), exports, and measures on the plans' held-out
meshes. OUT then holds ours.onnx, and figures.json with the time of each stage. Run it from the root of the
repository, with the meshes in data/. After an interruption give the same command again: it keeps everything
already rendered and trained.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from time import monotonic

import torch
import yaml

from normalgan.files.json_files import encode_json
from normalgan.files.writing import write_bytes

KINDS = ("animals", "people", "props", "rigs")
LICENCE = "MIT; trained on procedural shapes of normalgan and on CC0 meshes (docs/model_card.md)"
MEASURING = 0.15  # share of the time for export and figures


def main(arguments: list[str]) -> None:
    """Run all stages."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--minutes", type=float, default=40.0)
    parser.add_argument("--config", action="append", default=[])
    parser.add_argument("--plan", action="append", default=[])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args(arguments)
    started = monotonic()
    given.out.mkdir(parents=True, exist_ok=True)
    gpu = ["configs/gpu.yaml"] if torch.cuda.is_available() else []
    configs = ["configs/ours.yaml", "configs/shipped.yaml", *gpu, *given.config]
    took: dict[str, float] = {}

    def stage(name: str, *command: str | Path) -> None:
        start = monotonic()
        print(f"{name}: normalgan {' '.join(map(str, command))}", flush=True)
        subprocess.run([sys.executable, "-m", "normalgan", *map(str, command)], check=True)
        took[name] = round(took.get(name, 0) + monotonic() - start, 1)

    said = [part for config in configs for part in ("--config", config)]
    stage("render", "render", *said, "--data.storage.render_workers", str(given.workers))
    budget = 60 * given.minutes * (1 - MEASURING) - (monotonic() - started)
    overlay = given.out / "budget.yaml"
    if not overlay.exists():  # a resumed run has its own clock
        overlay.write_text(yaml.safe_dump(_budget(configs, budget, given.out)), encoding="utf-8")
    last = given.out / "checkpoints" / "last.ckpt"
    stage("train", "fit", *said, "--config", overlay, *(["--ckpt_path", last] if last.exists() else []))
    stage("export", "export", last, "-o", given.out / "ours.onnx", "--half", "--licence", LICENCE)
    figures = {}
    for plan in given.plan or [f"configs/benchmark/{kind}.yaml" for kind in KINDS]:
        folder = given.out / "measured" / Path(plan).stem
        stage("measure", "benchmark", "--config", plan, "--evaluate", given.out / "ours.onnx", "-o", folder)
        figures[Path(plan).stem] = json.loads((folder / "evaluation.json").read_text(encoding="utf-8"))
    report = {"configs": configs, "seconds": took, "figures": figures}
    write_bytes(given.out / "figures.json", encode_json(report))
    print(f"Figures: {given.out / 'figures.json'}")


def _budget(configs: list[str], seconds: float, out: Path) -> dict[str, object]:
    """Return the overlay that makes training take this many seconds, with all other callbacks kept."""
    callbacks: list[dict[str, object]] = []
    for config in configs:
        trainer = yaml.safe_load(Path(config).read_text(encoding="utf-8")).get("trainer") or {}
        callbacks = trainer.get("callbacks", callbacks)
    clock = "normalgan.callbacks.WallClockSchedule"
    kept = [each for each in callbacks if each["class_path"] != clock]
    kept.append({"class_path": clock, "init_args": {"seconds": max(seconds, 1.0), "warmup": 0.02}})
    return {"trainer": {"default_root_dir": str(out), "max_epochs": -1, "callbacks": kept}}


if __name__ == "__main__":
    main(sys.argv[1:])
