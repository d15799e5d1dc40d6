"""Train the runs of a benchmark one after the other, skipping finished runs."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import yaml

from normalgan.benchmark.runs import Run
from normalgan.benchmark.settings import differences
from normalgan.callbacks.checkpoints import best_checkpoint
from normalgan.errors import InputError, RunError, brief
from normalgan.files.writing import write_bytes

Result = dict[str, Any]
"""The result of a run; see `normalgan.benchmark.evaluation`."""
Results = Mapping[str, Sequence[Result]]
"""The results of each row, one per seed, by the name of the row."""

State = Literal["new", "begun", "trained", "done"]


def read_state(run: Run, evaluation: str) -> State:
    """Return the state of a run.

    Args:
        run: the run, whose folder may be missing.
        evaluation: hash of the evaluation; results of a different evaluation are ignored.

    Raises:
        InputError: if the folder holds a run with other settings.
    """
    record = _read(run.folder / "run.json")
    if record is None:
        return "new"
    if record["hash"] != run.hash:
        names = differences(record["identity"], run.identity)
        raise InputError(
            f"{run.folder} was made with other settings ({', '.join(names[:4])}); "
            "give another --output, or delete the folder."
        )
    if not record["trained"]:
        return "begun"
    return "done" if read_result(run, evaluation) else "trained"


def read_result(run: Run, evaluation: str) -> Result | None:
    """Return the result of a run that matches the plan; None if there is none."""
    result = _read(run.folder / "result.json")
    return result if result and (result["hash"], result["evaluation"]) == (run.hash, evaluation) else None


def run_all(
    runs: Iterable[Run],
    evaluation: str,
    train: Callable[[Run], None],
    evaluate: Callable[[Run], Result],
    report: Callable[[], None],
    say: Callable[[str], None],
) -> list[str]:
    """Train and measure unfinished runs, report after each, and return a message for each that failed.

    ``evaluation`` is the hash of the evaluation; ``say`` prints a message.
    """
    failures = []
    for run in runs:
        try:
            state = read_state(run, evaluation)
            if state == "done":
                say(f"{run.title}: done already")
                continue
            if state in {"new", "begun"}:
                _write(run, trained=False)
                if not run.row.classical:
                    say(f"{run.title}: {'training' if state == 'new' else 'resuming'}")
                    train(run)
                _write(run, trained=True)
            say(f"{run.title}: measuring")
            result = evaluate(run)
            write_json(run.folder / "result.json", {**result, "hash": run.hash, "evaluation": evaluation})
        except InputError as error:
            failures.append(f"{run.title} failed: {error}")
        except Exception as error:  # any exception, so that the other runs continue
            failures.append(f"{run.title} failed: {type(error).__name__}: {brief(error)}")
        else:
            report()
            continue
        say(failures[-1])
    return failures


def fit(run: Run) -> None:
    """Train a run with `normalgan fit` in a separate process, resuming an interrupted run.

    Raises:
        RunError: if training fails; its output is in ``train.log``.
        KeyboardInterrupt: if training was stopped.
    """
    settings, log = run.folder / "settings.yaml", run.folder / "train.log"
    write_bytes(settings, yaml.safe_dump(run.settings).encode())
    command = [sys.executable, "-m", "normalgan", "fit", "--config", str(settings)]
    last = run.folder / "checkpoints" / "last.ckpt"
    if last.is_file():
        command += ["--ckpt_path", str(last)]
    with log.open("a", encoding="utf-8") as lines:
        done = subprocess.run(command, stdout=lines, stderr=subprocess.STDOUT, check=False)
    if done.returncode == 130:
        raise KeyboardInterrupt
    if done.returncode:
        said = log.read_text(encoding="utf-8").strip().splitlines()
        raise RunError(f"its training ended with code {done.returncode}: {said[-1] if said else 'no output'}")


def measured_checkpoint(run: Run, which: Literal["best", "last"]) -> Path:
    """Return the checkpoint that is measured.

    Raises:
        RunError: if training has left no checkpoint.
        InputError: if the checkpoint cannot be read, or the best one is missing.
    """
    last = run.folder / "checkpoints" / "last.ckpt"
    if not last.is_file():
        raise RunError(f"training has left no checkpoint in {last.parent}.")
    return (best_checkpoint(last) if which == "best" else None) or last


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file atomically, with each list of numbers or names on one line."""
    write_bytes(path, (_dumped(content) + "\n").encode())


def _dumped(content: Any, depth: int = 0) -> str:
    inner, outer = "\n" + " " * (depth + 1), "\n" + " " * depth
    if isinstance(content, dict) and content:
        items = [f"{json.dumps(str(key))}: {_dumped(value, depth + 1)}" for key, value in content.items()]
        return "{" + inner + f",{inner}".join(items) + outer + "}"
    if isinstance(content, list | tuple) and any(isinstance(value, dict | list) for value in content):
        return "[" + inner + f",{inner}".join(_dumped(value, depth + 1) for value in content) + outer + "]"
    return json.dumps(content)


def _write(run: Run, trained: bool) -> None:
    write_json(run.folder / "run.json", {"hash": run.hash, "trained": trained, "identity": run.identity})


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except ValueError as error:
        raise InputError(f"{path} is damaged: {brief(error)}; delete the folder of the run.") from error
