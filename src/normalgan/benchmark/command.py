"""normalgan benchmark: trains and measures the methods of a plan, or measures one model."""

import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jsonargparse import Namespace

from normalgan.benchmark.plan import Plan, Row, is_plan, read_plan
from normalgan.benchmark.scale import Scale, read_budget, read_scale
from normalgan.cli.light_parser import LightParser
from normalgan.errors import InputError
from normalgan.files.shipped_configs import find_beside
from normalgan.files.writing import write_bytes
from normalgan.warning_filters import filter_warnings

if TYPE_CHECKING:  # they import torch
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.methods import Method

__all__ = [
    "build_parser",
    "check",
    "compare",
    "evaluate",
    "measure_human",
    "run",
    "score",
    "write_test_inputs",
]


def run(arguments: list[str]) -> int:
    """Run the command and return the exit code: 1 if a run failed.

    Raises:
        InputError: if an argument cannot be used.
        KeyboardInterrupt: if it was stopped.
    """
    options = build_parser().parse_args(arguments)
    if options.human is not None:
        return measure_human(options)
    apart = [name for name in ("inputs", "score", "evaluate") if getattr(options, name) is not None]
    if len(apart) > 1:
        raise InputError(
            f"--{apart[0]} and --{apart[1]} were given, and only one could be done; use a command for each."
        )
    plan, scale = _read(options)
    with warnings.catch_warnings():
        filter_warnings()
        out = Path(options.output) if options.output else None
        if options.spec is not None:
            check(plan, scale, find_beside(options.spec))
        if options.inputs is not None:
            return write_test_inputs(plan, scale, Path(options.inputs))
        if options.score is not None:
            return score(plan, scale, Path(options.score), out)
        if options.evaluate is not None:
            return evaluate(plan, scale, options.evaluate, out)
        chosen = options.rows.split(",") if options.rows else [row.name for row in plan.rows]
        for name in chosen:
            plan.row(name)
        seeds = _seeds(options.seeds) or plan.seeds
        return compare(plan, scale, out or Path("runs/benchmark"), chosen, seeds)


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan benchmark",
        usage="%(prog)s --config PLAN --config OVERLAY... [-o FOLDER] [--rows NAME,...] [--seeds N...]",
        description="Train and measure every method of a plan; go on where it was interrupted.",
    )
    parser.add_argument(
        "-c",
        "--config",
        action="append",
        type=str,
        help="the plan, a file with rows; and overlays of `normalgan fit`, which set the scale; may be given "
        "several times",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=str | None,
        help="folder of the runs and the report (default runs/benchmark); with --evaluate the folder of "
        "evaluation.json, which is not written without it",
    )
    parser.add_argument("--rows", type=str | None, help="names of rows, with commas; by default all")
    parser.add_argument("--seeds", type=str, nargs="+", help="seeds in place of the plan's")
    parser.add_argument(
        "--images", type=int | None, help="images that each generator learns from, in place of the plan's"
    )
    parser.add_argument(
        "--budget", type=str | None, help="wall-clock time of each run in place of the images, such as 8m"
    )
    parser.add_argument(
        "--set",
        action="extend",
        type=str,
        nargs="+",
        help="settings of data or trainer that override all others, such as data.size=64",
    )
    parser.add_argument(
        "--evaluate",
        type=str | None,
        help="measure a model as the plan does, and train nothing: a checkpoint, .safetensors, .onnx, or "
        "shipped, the one that comes with the package",
    )
    parser.add_argument(
        "--score",
        type=str | None,
        help="measure the normal maps in a folder that another program made, and train nothing",
    )
    parser.add_argument(
        "--inputs",
        type=str | None,
        help="write the sketches and hints of the test into a folder, for another program, and train nothing",
    )
    parser.add_argument(
        "--human",
        type=str | None,
        help="measure a model (that of --evaluate, or shipped) on drawings by people, in a folder with a "
        "drawings.json (docs/compare.md); takes no plan; --rows names groups",
    )
    parser.add_argument(
        "--spec",
        type=str | None,
        help="a frozen specification, such as configs/benchmark/v3.json; anything else is refused",
    )
    return parser


def compare(plan: Plan, scale: Scale, out: Path, rows: list[str], seeds: list[int]) -> int:
    """Train and measure rows of a plan, report, and return the exit code: 1 if a run failed.

    Args:
        plan: what is compared.
        scale: at which.
        out: folder of the runs and the report.
        rows: names of those to train; others are reported if they have results.
        seeds: seeds of the runs.
    """
    # Here, so that --help needs no torch.
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.report import Report
    from normalgan.benchmark.runs import plan_runs, shared_settings
    from normalgan.benchmark.training import fit, read_state, run_all

    every = plan_runs(plan, scale, out, sorted({*plan.seeds, *seeds}))
    runs = [r for r in every if r.row.name in rows and (r.seed is None or r.seed in seeds)]
    evaluation = Evaluation(plan, shared_settings(plan, scale))
    for one in every:  # before anything is trained
        try:
            read_state(one, evaluation.hash)
        except InputError as error:
            if one in runs:
                raise
            _say(f"left out of the report: {error}")
    report = Report(plan, scale, every, evaluation, out)
    failures = run_all(runs, evaluation.hash, fit, evaluation.of_run, report.write, _say)
    report.write()
    _say(f"\n{(out / 'table.md').read_text(encoding='utf-8')}")
    _say(f"Report: {out.resolve()}")
    for failure in failures:
        _say(failure)
    return 1 if failures else 0


def evaluate(plan: Plan, scale: Scale, name: str, out: Path | None = None) -> int:
    """Measure a model on the plan's test split, print its tables, and return the exit code.

    Args:
        plan: the plan.
        scale: its scale.
        name: name of the model's file, or ``shipped``.
        out: folder of ``evaluation.json``, which has all figures; None writes none.
    """
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.methods import saved_method
    from normalgan.benchmark.runs import shared_settings

    evaluation = Evaluation(plan, shared_settings(plan, scale), test_alone=True)
    method = saved_method(name, evaluation.shared["data"]["size"], evaluation.device)
    _report(evaluation, scale, name, method, out)
    return 0


def score(plan: Plan, scale: Scale, folder: Path, out: Path | None = None) -> int:
    """Measure another program's predictions of the test split, print tables, and return the exit code.

    Args:
        plan: the benchmark.
        scale: its picture size and networks.
        folder: folder of the submission; see `normalgan.benchmark.submissions`.
        out: as in `evaluate`.
    """
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.runs import shared_settings
    from normalgan.benchmark.submissions import read_submission

    submission = read_submission(folder)
    counts = list(submission.counts)
    predicted = replace(plan, hint_counts=counts, hints=max(counts) or plan.hints, pins=0)
    predicted = replace(predicted, placements=[], placement_counts=[], noise_degrees=[], noise_pixels=[])
    evaluation = Evaluation(predicted, shared_settings(plan, scale), test_alone=True)
    _report(evaluation, scale, submission.name, submission.method(), out)
    return 0


def write_test_inputs(plan: Plan, scale: Scale, folder: Path) -> int:
    """Write the sketches and hints of the plan's test split, and return the exit code.

    Args:
        plan: whose.
        scale: at which.
        folder: where to.
    """
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.runs import shared_settings
    from normalgan.benchmark.submissions import write_inputs

    evaluation = Evaluation(plan, shared_settings(plan, scale), test_alone=True)
    for batch in evaluation.batches():
        write_inputs(folder, batch, plan.counts, plan.hint_seed)
    _say(f"Sketches and hints: {folder.resolve()}")
    return 0


def measure_human(options: Namespace) -> int:
    """Measure a model on drawings by people, and return the exit code.

    Raises:
        InputError: if the folder or the model cannot be used, or an option does not apply.
    """
    from normalgan.benchmark.human import human

    for name in ("config", "seeds", "images", "budget", "set", "score", "inputs", "spec"):
        if getattr(options, name):
            raise InputError(f"--human takes no --{name}; it measures one model on the drawings of a folder.")
    groups = [group.strip() for group in (options.rows or "").split(",") if group.strip()]
    out = Path(options.output or "runs/human")
    with warnings.catch_warnings():
        filter_warnings()
        human(Path(options.human), options.evaluate or "shipped", out, groups, _say)
    return 0


def check(plan: Plan, scale: Scale, specification: Path) -> None:
    """Check that a plan at a scale uses the data of a frozen specification.

    Raises:
        InputError: if it does not.
    """
    from normalgan.benchmark.evaluation import Evaluation
    from normalgan.benchmark.runs import shared_settings
    from normalgan.benchmark.specification import check_specification

    evaluation = Evaluation(plan, shared_settings(plan, scale), test_alone=True)
    track = check_specification(evaluation.specification, specification)
    _say(f"{specification}: the track {track}" if track else f"{specification}: as it was frozen")


def _report(evaluation: "Evaluation", scale: Scale, name: str, method: "Method", out: Path | None) -> None:
    """Print the tables of a method's figures, and write the figures to a folder if one is given."""
    from normalgan.benchmark.curves import draw_calibration
    from normalgan.benchmark.table import markdown, mesh_table
    from normalgan.benchmark.training import write_json

    plan, figures = evaluation.plan, evaluation.of_method(method)
    one = replace(plan, rows=[Row("model", name, configs=["–"])], reference=None)
    shown = {"model": [{**figures, "seed": None, "images": 0, "curve": []}]}
    _say(markdown(one, scale, shown, evaluation.specification))
    _say(mesh_table(figures, plan.hints))
    if out is not None:
        head: dict[str, Any] = {"plan": plan.name, "scale": scale.name, "changed": scale.changed}
        head |= {"model": name, "specification": evaluation.specification}
        result = {"model": [{**figures, "seed": None}]}
        calibration = draw_calibration(one, result, f"{plan.name}, {name}")
        if calibration:
            write_bytes(out / "calibration.png", calibration)
        write_json(out / "evaluation.json", {**head, "size": evaluation.data.recipe.size, **figures})
        _say(f"Figures: {(out / 'evaluation.json').resolve()}")


def _read(options: Namespace) -> tuple[Plan, Scale]:
    files = options.config or []
    plans = [path for path in files if is_plan(path)]
    if len(plans) != 1:
        raise InputError(
            f"benchmark takes one plan, a --config file with rows such as configs/benchmark/fourlegs.yaml, "
            f"but was given {len(plans)}."
        )
    seconds = read_budget(options.budget) if options.budget else None
    overlays = [path for path in files if path not in plans]
    plan = read_plan(plans[0])
    if options.images is not None:
        plan = replace(plan, images=options.images)
    return plan, read_scale(overlays, options.set or (), seconds)


def _seeds(given: list[str] | None) -> list[int]:
    for text in given or ():
        if not text.isdecimal():
            raise InputError(
                f"--seeds was given {text!r}; use whole numbers, 0 or more, with spaces between."
            )
    return [int(text) for text in given or ()]


def _say(text: str) -> None:
    print(text, flush=True)
