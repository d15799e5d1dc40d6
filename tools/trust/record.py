"""Record: what an experiment found, and on what, kept in one JSON file as it goes on."""

import json
import sys
import time
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import torch

from normalgan.benchmark.machine import commit, describe_machine, describe_versions
from normalgan.files.writing import write_bytes

READ_BY = ("zarr", "trimesh", "pillow", "resvg-py", "PyYAML")
"""Libraries that write or read what is damaged here."""
Results = Mapping[str, Any]
"""What an experiment has counted so far; ``findings`` lists what went wrong, in words."""


def keep(path: Path, name: str, command: str, seed: int, experiment: Iterator[Results]) -> list[str]:
    """Run an experiment, write its section of a file after each of its steps, and return its findings.

    Args:
        path: of the file; the sections of other experiments in it are kept.
        name: of the section.
        command: that repeats it.
        seed: of its choices.
        experiment: yields what it has counted so far; at least once.
    """
    start = time.monotonic()
    made_on = {
        "command": command,
        "date": datetime.now(UTC).date().isoformat(),
        "commit": commit(),  # as it was at the start; "+": with changes that were not committed
        "seed": seed,
        "machine": describe_machine(torch.device("cpu")),
        "versions": describe_versions() | {name: version(name) for name in READ_BY},
    }
    results: Results = {}
    for results in experiment:
        _write(path, name, {**made_on, "finished": False, "seconds": _since(start), **results})
        print(f"{name} {_since(start)} s: {_brief(results)}", file=sys.stderr)
    _write(path, name, {**made_on, "finished": True, "seconds": _since(start), **results})
    return list(results["findings"])


def _since(start: float) -> int:
    return round(time.monotonic() - start)


def _brief(results: Results) -> str:
    return ", ".join(f"{key} {value}" for key, value in results.items() if isinstance(value, int | list))


def _write(path: Path, name: str, section: Results) -> None:
    # Read anew each time: another experiment may have written its section meanwhile.
    sections = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    content = {**sections, name: section}
    write_bytes(path, (json.dumps(dict(sorted(content.items())), indent=1) + "\n").encode())
