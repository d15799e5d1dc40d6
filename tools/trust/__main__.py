"""Tries what docs/reliability.md promises, many times: tools/trust EXPERIMENT [--count N] [-o FILE]."""

import argparse
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

EXPERIMENTS = {
    "kills-fit": ("kills_fit", 50, "training is killed, and resumed"),
    "kills-render": ("kills_render", 50, "rendering is killed, and run again"),
    "flips": ("flips", 50, "a bit of a rendered data set is flipped, and it is rendered again"),
    "mutations": ("mutations", 10_000, "damaged files are given to every reader"),
    "determinism": ("determinism", 2, "a run is repeated with the same seed"),
}
"""By name: the module and its function, which are named alike; how often it tries; what is done."""
TESTS = Path(__file__).parents[2] / "tests"


def main() -> int:
    """Run one of them; exit code 1 if it found anything."""
    told = "; ".join(f"{name}: {what}" for name, (_, _, what) in EXPERIMENTS.items())
    parser = argparse.ArgumentParser(prog="tools/trust", description=__doc__.splitlines()[0], epilog=told)
    parser.add_argument("experiment", choices=EXPERIMENTS)
    parser.add_argument("--count", type=int, help="kills, flips, mutants or runs")
    parser.add_argument("--seed", type=int, default=0, help="of moments, bits and mutants")
    parser.add_argument(
        "--work", type=Path, help="an empty folder to work in, and to keep; else it is removed"
    )
    parser.add_argument("-o", "--output", type=Path, required=True, help="JSON file; other sections stay")
    options = parser.parse_args()
    # Before torch is loaded, which reads them once: a process of one thread can be forked.
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    sys.path[:0] = [str(TESTS / part) for part in ("", "trust", "cli", "data")]
    from record import keep

    module, count, _ = EXPERIMENTS[options.experiment]
    experiment: Callable[[Path, int, int], Iterator[dict[str, Any]]] = getattr(import_module(module), module)
    count = options.count or count
    asked = f"{options.experiment} --count {count} --seed {options.seed}"
    with tempfile.TemporaryDirectory(prefix="trust-") as temporary:
        steps = experiment(options.work or Path(temporary), count, options.seed)
        findings = keep(
            options.output, options.experiment, f"python tools/trust {asked}", options.seed, steps
        )
    for finding in findings:
        print(finding)
    return int(bool(findings))


if __name__ == "__main__":
    sys.exit(main())
