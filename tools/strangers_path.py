"""Does what docs/plugins.md tells a stranger to, in an empty folder, and times it.

tools/strangers_path.py WHEEL RESULTS [FOLDER]

The files and commands are those of the section "From nothing to a table", copied from the page; the
environment is made by the first of the commands and holds nothing of this repository but the wheel. pip's own
variables say where it gets packages from, such as PIP_CONSTRAINT for one build of PyTorch.
"""

import json
import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from time import monotonic

PAGE = Path(__file__).parents[1] / "docs" / "plugins.md"
SECTION = "From nothing to a table"
ROWS = ("mean of the training maps", "hints on a grid", "hints anywhere")
"""What the last command must show."""


@dataclass
class Stage:
    """A step of the page: files that are written, then commands that are run."""

    name: str
    files: dict[str, str] = field(default_factory=dict)
    commands: str = ""


def stages(page: str) -> Iterator[Stage]:
    """Yield the steps that a page tells: a heading each, files under their names in bold, commands as sh."""
    section = re.split(r"^## ", page.split(f"\n## {SECTION}\n")[1], flags=re.M)[0]
    for text in re.split(r"^### ", section, flags=re.M)[1:]:
        stage = Stage(text.partition("\n")[0])
        for name, language, body in re.findall(
            r"(?:^\*\*`([^`]+)`\*\*\n\n)?^```(\w+)\n(.*?)^```$", text, re.M | re.S
        ):
            if name:
                stage.files[name] = body
            elif language == "sh":
                stage.commands += body
        yield stage


def walk(stage: Stage, folder: Path, log: Path) -> tuple[float, float]:
    """Do a step as in one terminal, and return the seconds it took, on the clock and of processors.

    Raises:
        SystemExit: if a command fails.
    """
    for name, body in stage.files.items():
        (folder / name).write_text(body, encoding="utf-8")
    kept = log.with_suffix(".env")  # what a terminal would remember: the environment that was activated
    commands = f"[ ! -e {kept} ] || . {kept}\n{stage.commands}\ndeclare -px > {kept}\n"
    begin, spent = monotonic(), processor_seconds()
    with log.open("ab") as out:
        done = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", commands],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.STDOUT,
            check=False,
        )
    if done.returncode:
        sys.exit(f"{stage.name!r} failed:\n{log.read_text(encoding='utf-8')[-4000:]}")
    return monotonic() - begin, processor_seconds() - spent


def processor_seconds() -> float:
    """Return what the commands so far took of all processors; a busy machine does not change it much."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(wheel: Path, results: Path, folder: Path) -> None:
    """Walk the whole path and write what it took."""
    for name in ("PYTHONPATH", "VIRTUAL_ENV"):
        os.environ.pop(name, None)
    if any(folder.iterdir()):
        sys.exit(f"{folder} is not empty.")
    shutil.copy(wheel, folder)
    log = Path(tempfile.mkdtemp()) / "log"
    took = []
    load = os.getloadavg()[0]
    for stage in stages(PAGE.read_text(encoding="utf-8")):
        seconds, processor = walk(stage, folder, log)
        took.append(
            {"stage": stage.name, "seconds": round(seconds, 1), "processor_seconds": round(processor, 1)}
        )
        print(f"{stage.name}: {seconds:.1f} s, {processor:.1f} s of processors", flush=True)
    said = log.read_text(encoding="utf-8")
    if missing := [row for row in ROWS if f"| {row} " not in said]:
        sys.exit(f"the table has no row {missing[0]!r}:\n{said[-4000:]}")
    machine = {"cores": os.cpu_count(), "python": platform.python_version(), "load_before": round(load, 2)}
    written = {"date": f"{datetime.now(UTC):%Y-%m-%d}", "machine": machine, "stages": took}
    for unit in ("seconds", "processor_seconds"):
        written[unit] = round(sum(one[unit] for one in took), 1)
    results.write_text(json.dumps(written, indent=1) + "\n", encoding="utf-8")
    print(said[said.rindex("# ") :] if "# " in said else "", f"all: {written['seconds']} s", sep="\n")


if __name__ == "__main__":
    if len(sys.argv) not in {3, 4}:
        sys.exit(__doc__)
    given = Path(sys.argv[3]) if len(sys.argv) == 4 else Path(tempfile.mkdtemp())
    given.mkdir(parents=True, exist_ok=True)
    main(Path(sys.argv[1]), Path(sys.argv[2]), given.resolve())
