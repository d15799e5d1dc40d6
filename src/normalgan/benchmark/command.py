"""normalgan benchmark: train and measure the methods of a plan, or measure one model."""

import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path

from jsonargparse import Namespace
from jsonargparse.typing import NonNegativeInt

from normalgan.benchmark.plan import Plan, is_plan, read_plan
from normalgan.benchmark.scale import Scale, read_budget, read_scale
from normalgan.cli.parsing.light_parser import LightParser
from normalgan.errors import InputError
from normalgan.files.shipped_configs import find_beside
from normalgan.warning_filters import filter_warnings


def run(arguments: list[str]) -> int:
    """Run the command and return the exit code, which is 1 if a run failed.

    Raises:
        InputError: if an argument is invalid.
        KeyboardInterrupt: if the command was stopped.
    """
    options = build_parser().parse_args(arguments)
    if options.human is not None:
        return _measure_human(options)
    apart = [name for name in ("inputs", "score", "evaluate") if getattr(options, name) is not None]
    if len(apart) > 1:
        raise InputError(f"--{apart[0]} and --{apart[1]} cannot be combined; run a command for each.")
    plan, scale = _read(options)
    out = Path(options.output) if options.output else None
    with warnings.catch_warnings():
        filter_warnings()
        from normalgan.benchmark import actions  # imported here so that --help does not need torch

        if options.spec is not None:
            actions.check(plan, scale, find_beside(options.spec))
        if options.inputs is not None:
            return actions.write_test_inputs(plan, scale, Path(options.inputs))
        if options.score is not None:
            return actions.score(plan, scale, Path(options.score), out)
        if options.evaluate is not None:
            return actions.evaluate(plan, scale, options.evaluate, out)
        rows = options.rows.split(",") if options.rows else [row.name for row in plan.rows]
        for name in rows:
            plan.row(name)
        return actions.compare(plan, scale, out or Path("runs/benchmark"), rows, options.seeds or plan.seeds)


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan benchmark",
        usage="%(prog)s --config PLAN --config OVERLAY... [-o FOLDER] [--rows NAME,...] [--seeds N...]",
        description="Train and measure every method of a plan; an interrupted benchmark is resumed.",
    )
    parser.add_argument(
        "-c",
        "--config",
        action="append",
        type=str,
        help="plan (a file with rows), and overlays of `normalgan fit` that set the scale; can be given "
        "several times",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=str | None,
        help="folder of the runs and the report (default runs/benchmark); with --evaluate, the folder of "
        "evaluation.json, which is not written without it",
    )
    parser.add_argument("--rows", type=str | None, help="comma-separated names of rows; by default all")
    parser.add_argument("--seeds", type=NonNegativeInt, nargs="+", help="seeds instead of the plan's")
    parser.add_argument(
        "--images", type=int | None, help="number of training images of each generator, instead of the plan's"
    )
    parser.add_argument(
        "--budget", type=str | None, help="wall-clock time of each run instead of the images, such as 8m"
    )
    parser.add_argument(
        "--set",
        action="extend",
        type=str,
        nargs="+",
        help="data or trainer settings that override all others, such as data.size=64",
    )
    parser.add_argument(
        "--evaluate",
        type=str | None,
        help="measure a model like the methods of the plan, without training: a checkpoint, .safetensors, "
        ".onnx, or shipped",
    )
    parser.add_argument(
        "--score", type=str | None, help="measure a folder of another program's normal maps, without training"
    )
    parser.add_argument(
        "--inputs",
        type=str | None,
        help="write the sketches and hints of the test to a folder for another program, without training",
    )
    parser.add_argument(
        "--human",
        type=str | None,
        help="measure a model (from --evaluate, or shipped) on drawings by people in a folder with a "
        "drawings.json (docs/compare.md); needs no plan; --rows names groups",
    )
    parser.add_argument(
        "--spec",
        type=str | None,
        help="frozen specification that the test data must match, such as configs/benchmark/v3.json",
    )
    return parser


def _measure_human(options: Namespace) -> int:
    """Measure a model on drawings by people, and return the exit code.

    Raises:
        InputError: if the folder or the model is invalid, or an option does not apply.
    """
    for name in ("config", "seeds", "images", "budget", "set", "score", "inputs", "spec"):
        if getattr(options, name):
            raise InputError(f"--human takes no --{name}; it measures one model on the drawings of a folder.")
    groups = [group.strip() for group in (options.rows or "").split(",") if group.strip()]
    out = Path(options.output or "runs/human")
    with warnings.catch_warnings():
        filter_warnings()
        from normalgan.benchmark.human import human  # imported here, as above

        human(Path(options.human), options.evaluate or "shipped", out, groups, partial(print, flush=True))
    return 0


def _read(options: Namespace) -> tuple[Plan, Scale]:
    files = options.config or []
    plans = [path for path in files if is_plan(path)]
    if len(plans) != 1:
        given = ", ".join(map(str, plans)) if plans else "only overlays" if files else "no --config"
        raise InputError(
            "benchmark takes one plan, a --config file with rows such as configs/benchmark/fourlegs.yaml, "
            f"but was given {given}."
        )
    seconds = read_budget(options.budget) if options.budget else None
    overlays = [path for path in files if path not in plans]
    plan = read_plan(plans[0])
    if options.images is not None:
        plan = replace(plan, images=options.images)
    return plan, read_scale(overlays, options.set or (), seconds)
