"""Tries what docs/trust.md promises, many times: tools/trust EXPERIMENT… [--count N] [-o FILE]."""

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
    """Run them one after the other; exit code 1 if they found anything."""
    told = "; ".join(f"{name}: {what}" for name, (_, _, what) in EXPERIMENTS.items())
    parser = argparse.ArgumentParser(prog="tools/trust", description=__doc__.splitlines()[0], epilog=told)
    parser.add_argument("experiments", nargs="+", choices=EXPERIMENTS, metavar="EXPERIMENT")
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

    findings = []
    for name in options.experiments:
        module, count, _ = EXPERIMENTS[name]
        experiment: Callable[[Path, int, int], Iterator[dict[str, Any]]] = getattr(
            import_module(module), module
        )
        count = options.count or count
        asked = f"python tools/trust {name} --count {count} --seed {options.seed}"
        with tempfile.TemporaryDirectory(prefix="trust-") as temporary:
            work = options.work / name if options.work else Path(temporary)
            findings += keep(options.output, name, asked, options.seed, experiment(work, count, options.seed))
    for finding in findings:
        print(finding)
    return int(bool(findings))


if __name__ == "__main__":
    sys.exit(main())
