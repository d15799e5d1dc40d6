"""Reading hostile files in a process of its own, under limits of memory and time that the system enforces."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

MEMORY = 2 * 2**30
"""Bytes of address space that reading may take, on top of what libraries map."""
SECONDS = 5
"""Processor time that one file may take."""
GRACE = 120
"""Wall time for a process on a busy machine: a hang that takes no processor time ends here."""


@dataclass(frozen=True)
class Answer:
    """What a reader made of a file: ``read``, ``refused`` or ``broke``, and in what words."""

    name: str
    outcome: str
    words: str
    seconds: float


def read_limited(reader: str, files: list[Path]) -> list[Answer]:
    """Have files read one after the other by one of the readers of `readers.py`, in one process.

    Raises:
        AssertionError: if the process ends before the last of them: a crash, a hang, or no memory.
    """
    process = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("readers.py")), reader, str(MEMORY), str(SECONDS)],
        input="\n".join(map(str, files)),
        env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=GRACE,
        check=False,
    )
    answers = [Answer(**json.loads(line)) for line in process.stdout.splitlines()]
    if len(answers) < len(files):
        last = files[len(answers)]
        raise AssertionError(f"{reader} ended with {process.returncode} at {last}: {process.stderr[-2000:]}")
    return answers
