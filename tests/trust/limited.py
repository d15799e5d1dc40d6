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
GRACE = 240
"""Wall time for a process on a busy machine: a hang that takes no processor time ends here."""


@dataclass(frozen=True)
class Answer:
    """What a reader made of a file: ``read``, ``refused`` or ``broke``, and in what words.

    Args:
        name: of the file.
        outcome: of the three.
        words: that refuse it, or of the exception.
        seconds: of processor time.
        memory: bytes of memory that it took at its largest, on top of what the process had.
    """

    name: str
    outcome: str
    words: str
    seconds: float
    memory: int


class EndedError(AssertionError):
    """The process ended before the last file: a crash, a hang, or no memory.

    Args:
        answers: for the files before.
        file: at which it ended.
        words: that it left.
    """

    def __init__(self, answers: list[Answer], file: Path, words: str) -> None:
        super().__init__(f"ended at {file}: {words}")
        self.answers = answers
        self.file = file
        self.words = words


def read_limited(reader: str, files: list[Path]) -> list[Answer]:
    """Have files read one after the other by one of the readers of `readers.py`, in one process.

    Raises:
        EndedError: if the process ends before the last of them: a crash, a hang, or no memory.
    """
    command = [sys.executable, str(Path(__file__).with_name("readers.py")), reader, str(MEMORY), str(SECONDS)]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        text=True,
    )
    try:
        out, err = process.communicate("\n".join(map(str, files)), GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        err += f"not done after {GRACE} s"
    answers = [Answer(**json.loads(line)) for line in out.splitlines()]
    if len(answers) < len(files):
        last = files[len(answers)]
        raise EndedError(answers, last, f"{reader} ended with {process.returncode}: {err[-2000:]}")
    return answers
