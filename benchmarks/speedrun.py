"""Speedrun: how long the same small training takes to reach a fixed validation error, with one idea changed.

    python benchmarks/speedrun.py
    python benchmarks/speedrun.py --model.generator.init_args.patch=4

The recipe is benchmarks/speedrun.yaml, and the options are those of `normalgan fit`. The clock runs on one
thread, from the start of training to the validation at which the error with hints reaches the target. Compare
runs on one idle machine, and over three seeds (--seed_everything) if they are close.
"""

import json
import os
import sys
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from machine import ONE_THREAD

HERE = Path(__file__).parent
ERROR = "val/hints/angular_mean"
TARGET = 20.0
"""The validation error with hints that ends the race, in degrees."""


def seconds_to(curve: Sequence[Mapping[str, Any]], target: float) -> float | None:
    """Return the seconds at which a learning curve, interpolated, reaches an error; None if it never does.

    >>> curve = [{"seconds": 10, ERROR: 30.0}, {"seconds": 20, ERROR: 20.0}]
    >>> seconds_to(curve, 25.0), seconds_to(curve, 35.0), seconds_to(curve, 5.0)
    (15.0, 10.0, None)
    """
    known = [(float(point["seconds"]), float(point[ERROR])) for point in curve if point[ERROR] is not None]
    if known and known[0][1] <= target:
        return known[0][0]
    for (start, before), (end, after) in pairwise(known):
        if after <= target:
            return start + (before - target) / (before - after) * (end - start)
    return None


def train(settings: Sequence[str], folder: Path) -> list[dict[str, Any]]:
    """Train the recipe with settings of `normalgan fit` on top, and return its learning curve."""
    from normalgan.__main__ import main

    recipe = ["--config", str(HERE / "speedrun.yaml"), "--trainer.default_root_dir", str(folder)]
    code = main(["fit", *recipe, "--trainer.callbacks+=normalgan.callbacks.LearningCurve", *settings])
    if code:
        raise SystemExit(code)
    curve: list[dict[str, Any]] = json.loads((folder / "curve.json").read_text(encoding="utf-8"))
    return curve


if __name__ == "__main__":
    if os.environ.get("OMP_NUM_THREADS") != "1":  # libraries read it on import
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    with TemporaryDirectory() as folder:
        taken = seconds_to(train(sys.argv[1:], Path(folder)), TARGET)
    print(f"{TARGET:g}° " + ("was not reached." if taken is None else f"after {taken:.0f} s."))
