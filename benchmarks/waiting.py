"""How long training waits for its data: shards in memory, shards on disk, samples rendered on the fly.

    python benchmarks/waiting.py -o docs/results/waiting.json
    python benchmarks/waiting.py --config configs/paper.yaml --config configs/gpu.yaml --steps 500

Each row is a run of ``normalgan fit`` with the real model, in a process of its own, one after another. The
time between two batches is the step; the time in which the loader is asked for one is waiting. The first
steps are left out: the workers start, and queues fill. Memory is that of all processes of the run together, a
page that several share counted once (PSS), during these steps; growth is its rise from their first half to
their second.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from statistics import mean, median

import psutil
import yaml
from machine import describe

ANIMALS, TRAINED_ON = 10, 8
"""Embedded animals, and how many of them are trained on."""

CASES: dict[str, dict[str, object]] = {
    "shards in memory": {"workers": 0},
    "shards on disk": {"workers": 0, "memory": 0},
    "shards on disk, 2 workers": {"workers": 2, "memory": 0},
    "on the fly": {"on_the_fly": True, "workers": 0},
    "on the fly, 1 worker": {"on_the_fly": True, "workers": 1},
    "on the fly, 2 workers": {"on_the_fly": True, "workers": 2},
}
"""What is compared: name, and settings of the data."""


@dataclass(frozen=True)
class Row:
    """A run's figures.

    Args:
        data: where samples come from.
        step_ms: mean time from batch to batch.
        median_ms: its median.
        waiting: share of that time in which the loader was asked for a batch.
        samples_per_s: samples trained on in a second.
        first_s: until the first batch came: the workers start, or the first samples are rendered.
        peak_mb: most memory of all processes together.
        growth_mb: rise of the mean of that memory from the first half of the steps to the second.
    """

    data: str
    step_ms: float
    median_ms: float
    waiting: float
    samples_per_s: float
    first_s: float
    peak_mb: float
    growth_mb: float


def measure(name: str, options: argparse.Namespace, folder: Path) -> Row:
    """Run one case, and return its figures."""
    watch = folder / "stopwatch.json"
    process = subprocess.Popen(command("fit", CASES[name], options, folder, watch), env=environment())
    memory = []
    while process.poll() is None:
        memory.append((time.perf_counter(), memory_of(process.pid) / 2**20))
        time.sleep(0.25)
    if process.returncode:
        raise SystemExit(f"the run with {name} failed.")
    times = json.loads(watch.read_text())
    asked, came = times["asked"][options.warmup :], times["came"][options.warmup :]
    steps = [after - before for before, after in pairwise(asked)]
    waits = [got - wanted for wanted, got in zip(asked[:-1], came, strict=False)]
    taken = [amount for moment, amount in memory if asked[0] <= moment <= asked[-1]]
    return Row(
        data=name,
        step_ms=1000 * mean(steps),
        median_ms=1000 * median(steps),
        waiting=sum(waits) / sum(steps),
        samples_per_s=options.batch_size / mean(steps),
        first_s=times["came"][0] - times["asked"][0],
        peak_mb=max(taken),
        growth_mb=mean(taken[len(taken) // 2 :]) - mean(taken[: len(taken) // 2]),
    )


def command(
    verb: str, case: dict[str, object], options: argparse.Namespace, folder: Path, watch: Path
) -> list[str]:
    """Return the command line of one run."""
    batches = options.warmup + options.steps + 1
    data = {
        "meshes": None,
        "animals": ANIMALS,
        "fractions": [0.8, 0.1, 0.1],
        "train_views": -(-batches * options.batch_size // TRAINED_ON),
        "val_views": 1,
        "test_views": 1,
        "batch_size": options.batch_size,
        "cache": str(folder / "cache"),
        "renderer": {"class_path": options.renderer},
        **case,
    }
    trainer = {
        "default_root_dir": tempfile.mkdtemp(dir=folder),
        "max_epochs": 1,
        "limit_train_batches": batches,
        "limit_val_batches": 0,
        "num_sanity_val_steps": 0,
        "logger": False,
        "enable_progress_bar": False,
        "enable_model_summary": False,
    }
    if verb == "fit":
        trainer["profiler"] = {"class_path": "stopwatch.Stopwatch", "init_args": {"path": str(watch)}}
    overlay = folder / "overlay.yaml"
    checkpoint = {"monitor": None, "save_top_k": 0, "filename": "unused"}
    overlay.write_text(yaml.safe_dump({"data": data, "trainer": trainer, "checkpoint": checkpoint}))
    configs = [part for config in [*options.config, overlay] for part in ("--config", str(config))]
    return [sys.executable, "-m", "normalgan", verb, *configs]


def environment() -> dict[str, str]:
    """Return an environment in which the run finds the stopwatch."""
    return {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}


def memory_of(pid: int) -> int:
    """Return the bytes that a process and its children take, shared pages counted once."""
    total = 0
    try:
        root = psutil.Process(pid)
        family = [root, *root.children(recursive=True)]
    except psutil.NoSuchProcess:
        return 0
    for process in family:
        try:
            total += process.memory_full_info().pss
        except (psutil.NoSuchProcess, psutil.AccessDenied):  # it has just ended
            continue
    return total


def table(rows: list[Row]) -> str:
    """Return the figures in Markdown."""
    head = "| data | ms a step | waiting | samples/s | first batch s | peak MB | growth MB |\n"
    head += "| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
    return head + "".join(
        f"| {r.data} | {r.step_ms:.0f} | {r.waiting:.1%} | {r.samples_per_s:.1f} | {r.first_s:.1f} "
        f"| {r.peak_mb:.0f} | {r.growth_mb:+.0f} |\n"
        for r in rows
    )


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--config", action="append", help="configuration; repeats (quickstart.yaml)")
    parser.add_argument("--steps", type=int, default=200, help="steps that count (200)")
    parser.add_argument("--warmup", type=int, default=20, help="steps before them (20)")
    parser.add_argument("--batch-size", type=int, default=16, help="samples a batch (16)")
    parser.add_argument("--renderer", default="PyrenderRenderer", help="renderer (PyrenderRenderer)")
    parser.add_argument("--only", choices=CASES, action="append", help="a case; repeats (all)")
    parser.add_argument("-o", "--output", type=Path, help="JSON file for the figures")
    options = parser.parse_args()
    options.config = options.config or [Path(__file__).parents[1] / "configs" / "quickstart.yaml"]
    cases = options.only or list(CASES)
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for flying in (False, True):  # so that no run renders what is kept
            render = command("render", {"on_the_fly": flying}, options, folder, folder)
            subprocess.run(render, env=environment(), check=True)
        for name in cases:
            rows.append(measure(name, options, folder))
            print(table(rows[-1:]).splitlines()[-1], file=sys.stderr)
    print(table(rows))
    if options.output:
        settings = {
            k: v for k, v in vars(options).items() if k in {"steps", "warmup", "batch_size", "renderer"}
        }
        settings["config"] = [Path(config).name for config in options.config]
        report = {**describe("torch", "lightning"), "settings": settings, "rows": [asdict(r) for r in rows]}
        options.output.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
