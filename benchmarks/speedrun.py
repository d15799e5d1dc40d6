"""Speedrun: how much computing until a fixed validation error, one idea after the other at equal cost.

    python benchmarks/speedrun.py --idea baseline
    python benchmarks/speedrun.py --idea "4 x 4 stem" --set model.generator.init_args.patch=4

The recipe is benchmarks/speedrun.yaml; `--set` changes it. A run trains on one core, or on one GPU with
`--set trainer.accelerator=gpu`, until the mean angular error of the validation samples, with hints as in
training, is at the target, or the recipe is at its end, or the cost is half as high again as that of the
last record. Only training counts: rendering, start and validation do not. On a processor the cost is the
time that the process had a core. Other work beside it slows memory and caches down for all; a yardstick,
measured now and then, takes that out again for the kinds of core in speedrun_cost.py. On a GPU the cost
is the time by the clock.

Every run that ends leaves a line in docs/results/speedrun.jsonl, what did not help too. An idea is a
record if it reaches the target at less cost than the last one on the same kind of device, in the mean
over no fewer seeds. Where it gains less than 0.3 degrees at equal cost, three seeds are to tell: --seeds 0 1
2. The same command again goes on with what was interrupted.
"""

import argparse
import hashlib
import json
import os
import sys
import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from machine import ONE_THREAD, describe

HERE = Path(__file__).parent
RECIPE = HERE / "speedrun.yaml"
LOG = HERE.parent / "docs" / "results" / "speedrun.jsonl"
TARGET = 20.0
"""Degrees: the fixed validation error, with hints."""
SLACK = 1.5
"""How many times the last record's cost an idea may take."""

Line = dict[str, Any]


def load_log(path: Path) -> list[Line]:
    """Return what has been tried, in order."""
    if not path.is_file():
        return []
    return [json.loads(text) for text in path.read_text(encoding="utf-8").splitlines() if text.strip()]


def append(path: Path, line: Line) -> None:
    """Add a line to the log: the file is written anew and renamed, so that it is never half there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [json.dumps(one) for one in [*load_log(path), line]]
    partly = path.with_suffix(".tmp")
    partly.write_text("\n".join(lines) + "\n", encoding="utf-8")
    partly.replace(path)


def digest(content: Any) -> str:
    """Return ten letters and digits that stand for settings."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:10]


def cost_to(curve: Sequence[dict[str, Any]], target: float) -> float | None:
    """Return the cost in seconds at which a curve first is at a target, between its points; None if never.

    >>> curve = [{"cost": 10, "hints": 30.0}, {"cost": 20, "hints": 20.0}]
    >>> cost_to(curve, 25.0), cost_to(curve, 35.0), cost_to(curve, 5.0)
    (15.0, 10.0, None)
    """
    before: dict[str, Any] | None = None
    for point in curve:
        if point["hints"] is not None and point["hints"] <= target:
            if before is None or before["hints"] is None:
                return float(point["cost"])
            share = (before["hints"] - target) / (before["hints"] - point["hints"])
            return float(before["cost"] + share * (point["cost"] - before["cost"]))
        before = point
    return None


def error_at(curve: Sequence[dict[str, Any]], cost: float) -> float | None:
    """Return the error of a curve at a cost, between its points; None before the first and after the last.

    >>> error_at([{"cost": 10, "hints": 30.0}, {"cost": 20, "hints": 20.0}], 12.5)
    27.5
    """
    known = [point for point in curve if point["hints"] is not None]
    for before, after in pairwise(known):
        if before["cost"] <= cost <= after["cost"]:
            share = (cost - before["cost"]) / (after["cost"] - before["cost"])
            return float(before["hints"] + share * (after["hints"] - before["hints"]))
    return None


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if len(known) == len(values) and known else None


def tries(lines: Sequence[Line], track: str, device: str) -> list[list[Line]]:
    """Return the lines of a track and kind of device, those of one idea and settings together, in order."""
    found: dict[str, list[Line]] = {}
    for line in lines:
        if (line["track"], line["device"]) == (track, device):
            found.setdefault(digest([line["idea"], line["set"]]), []).append(line)
    return list(found.values())


def mean_cost(lines: Sequence[Line]) -> float | None:
    """Return the mean cost of an idea over its seeds; None if one of them did not reach the target."""
    return _mean([line["cost_to_target"] for line in lines])


def record_of(lines: Sequence[Line], track: str, device: str) -> list[Line] | None:
    """Return the lines of the last record."""
    record: list[Line] | None = None
    for one in tries(lines, track, device):
        record = one if beats(one, record) else record
    return record


def beats(now: Sequence[Line], record: Sequence[Line] | None) -> bool:
    """Return whether an idea is a record: at less cost than the last one, over no fewer seeds."""
    cost, best = mean_cost(now), mean_cost(record) if record else None
    return cost is not None and (best is None or (len(now) >= len(record or ()) and cost < best))


def comparison(now: Sequence[Line], record: Sequence[Line] | None, target: float) -> str:
    """Return in words and a table how an idea stands beside the last record, at equal cost."""
    cost = mean_cost(now)
    lines = [f"{now[0]['idea']}: {_minutes(cost)} to {target:g}° ({len(now)} seed{'s' * (len(now) > 1)})"]
    if record is None:
        return "\n".join([*lines, "There is no record yet on this kind of device."])
    best = mean_cost(record)
    lines.append(f"last record, {record[0]['idea']}: {_minutes(best)} ({len(record)} seeds)")
    ends = [line["curve"][-1]["cost"] for line in (*now, *record)]
    lines += [
        "",
        "| cost, s | " + now[0]["idea"] + " | " + record[0]["idea"] + " | gain |",
        "| ---: " * 4 + "|",
    ]
    gains = []
    for share in (0.1, 0.25, 0.5, 0.75, 1.0):
        at = share * min(ends)
        new, old = (_mean([error_at(line["curve"], at) for line in part]) for part in (now, record))
        if new is not None and old is not None:
            gains.append(old - new)
            lines.append(f"| {at:.0f} | {new:.2f}° | {old:.2f}° | {old - new:+.2f}° |")
    if gains and abs(gains[-1]) < 0.3 and min(len(now), len(record)) < 3:
        lines += ["", "The gain at the end is below 0.3°: three seeds of both are to tell, --seeds 0 1 2."]
    return "\n".join(lines)


def gain(now: Sequence[Line], record: Sequence[Line]) -> tuple[float, float] | None:
    """Return degrees by which an idea is ahead of a record, and the cost in seconds at which it is.

    Over the seeds that both have, at the largest cost that all of their runs came to; None if there is no
    such seed or cost.
    """
    seeds = {line["seed"] for line in now} & {line["seed"] for line in record}
    parts = [[line["curve"] for line in part if line["seed"] in seeds] for part in (now, record)]
    if not seeds:
        return None
    at = min(curve[-1]["cost"] for part in parts for curve in part)
    new, old = (_mean([error_at(curve, at) for curve in part]) for part in parts)
    return (old - new, at) if new is not None and old is not None else None


def rows(lines: Sequence[Line], track: str, device: str) -> list[str]:
    """Return rows of a table in Markdown of all that was tried.

    Cells are the idea, seconds of seeds 0, 1 and 2, their mean, how far ahead of the record of its time the
    idea is at equal cost, and what is to be said of it.
    """
    found: list[str] = []
    before: list[Line] | None = None
    for one in tries(lines, track, device):
        seconds = {line["seed"]: line["cost_to_target"] for line in one}
        cells = [_seconds(seconds[seed]) if seed in seconds else "" for seed in (0, 1, 2)]
        mean, ahead = mean_cost(one), gain(one, before) if before else None
        is_record = beats(one, before)
        cells.append("" if len(one) == 1 else f"**{_seconds(mean)}**" if is_record else _seconds(mean))
        # + 0.0: no -0.0
        cells.append(f"{round(ahead[0], 1) + 0.0:+.1f}° at {ahead[1]:.0f} s" if ahead else "")
        found.append("| " + " | ".join([one[0]["idea"], *cells, one[-1]["note"]]) + " |")
        before = one if is_record else before
    return found


def _seconds(seconds: float | None) -> str:
    return "not reached" if seconds is None else f"{seconds:.0f}"


def _minutes(seconds: float | None) -> str:
    return "not reached" if seconds is None else f"{seconds / 60:.2f} min"


def train(settings: list[str], seed: int, folder: Path, target: float, most: float | None) -> list[Line]:
    """Train one run in its folder, or go on with it, and return its curve.

    Args:
        settings: on top of the recipe, each ``name=value``.
        seed: of initialisation, hints and order.
        folder: of the run.
        target: degrees at which it stops.
        most: seconds of cost at which it stops; None for no limit.
    """
    from normalgan.__main__ import main

    stop = {"target": target, "most": most}
    (folder / "stop.json").parent.mkdir(parents=True, exist_ok=True)
    (folder / "stop.json").write_text(json.dumps(stop), encoding="utf-8")
    arguments = ["fit", "--config", str(RECIPE), "--trainer.default_root_dir", str(folder)]
    arguments += ["--trainer.callbacks+=speedrun_cost.Cost", "--trainer.enable_progress_bar", "false"]
    arguments += ["--seed_everything", str(seed), "--model.seed", str(seed)]
    arguments += [f"--{one}" for one in settings]
    last = folder / "checkpoints" / "last.ckpt"
    if last.is_file():
        arguments += ["--ckpt_path", str(last)]
    code = main(arguments)
    curve = folder / "cost.json"
    if code or not curve.is_file():
        raise SystemExit(f"the training in {folder} ended with code {code}.")
    found: list[Line] = json.loads(curve.read_text(encoding="utf-8"))
    return found


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Return what the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--idea", required=True, help="what is tried, in a few words")
    parser.add_argument("--set", nargs="+", action="extend", default=[], help="settings, name=value")
    parser.add_argument("--seeds", nargs="+", type=int, default=[0])
    parser.add_argument("--target", type=float, default=TARGET, help="degrees; another one is another track")
    parser.add_argument("--log", type=Path, default=LOG)
    parser.add_argument("--runs", type=Path, default=Path("runs/speedrun"), help="where runs are kept")
    parser.add_argument("--note", default="", help="what is to be said of it")
    options = parser.parse_args(arguments)
    wrong = [one for one in options.set if "=" not in one]
    if wrong:
        parser.error(f"--set was given {wrong[0]!r}; write name=value, like data.batch_size=32.")
    return options


def speedrun(options: argparse.Namespace) -> str:
    """Run what the command line asks for, log it, and return the comparison."""
    import torch

    torch.set_num_threads(1)
    on_gpu = any(one.startswith("trainer.accelerator=") and "cpu" not in one for one in options.set)
    # A core with wider instructions is another kind of device.
    core = f"one core, {torch.backends.cpu.get_cpu_capability()}"
    device = torch.cuda.get_device_name() if on_gpu else core
    track = digest([RECIPE.read_text(encoding="utf-8"), options.target])
    logged = load_log(options.log)
    record = record_of(logged, track, device)
    best = mean_cost(record) if record else None
    now = []
    for seed in options.seeds:
        key = digest([track, device, options.set, seed])
        same = [line for line in logged if line["run"] == key]
        if same:
            print(f"seed {seed}: done already, in the log")
            now += same
            continue
        start = time.monotonic()
        curve = train(options.set, seed, options.runs / key, options.target, best and SLACK * best)
        line: Line = {"idea": options.idea, "set": options.set, "seed": seed, "track": track, "run": key}
        line |= {"device": device, "target": options.target, "cost_to_target": cost_to(curve, options.target)}
        line |= {
            "note": options.note,
            "waited": round(time.monotonic() - start),
            **describe("torch", "lightning"),
        }
        now.append({**line, "curve": curve})
    is_record = beats(now, record)
    for line in now:
        if line not in logged:
            append(options.log, {**line, "record": is_record})
    said = comparison(now, record, options.target)
    return said + ("\n\nA new record." if is_record else "")


if __name__ == "__main__":
    if os.environ.get("OMP_NUM_THREADS") != "1":  # libraries read it when they are imported
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.path.insert(0, str(HERE))
    print(speedrun(parse()))
