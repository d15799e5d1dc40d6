"""Nursery: commands in children of a process that has imported everything, each killed at some moment.

Importing takes ten seconds, a tiny run three: forked children make many kills cheap.
"""

import os
import signal
import sys
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

import psutil
from changes import tell_changes
from moments import Moment

import normalgan.cli.training  # noqa: F401 -- so that a forked child need not
from normalgan.__main__ import main

PATIENCE = 900.0
"""Seconds after which a child hangs; a tiny run takes three, on a machine with ten others' work minutes."""
TICK = 0.002


@dataclass(frozen=True)
class Child:
    """How a child ended.

    Args:
        code: of its exit; negative for the signal that ended it.
        said: on both streams.
        changes: event and path of each change of its folder; empty for a fresh process.
        seconds: that it took.
        orphans: processes of its own that outlived it.
    """

    code: int
    said: str
    changes: list[str]
    seconds: float
    orphans: int

    @property
    def killed(self) -> bool:
        """Whether the signal came before it was done."""
        return self.code == -signal.SIGKILL

    def troubles(self) -> list[str]:
        """Return what is wrong with it, if it should have ended by itself."""
        found = [f"it ended with {self.code}: {self.said[-300:]}"] if self.code else []
        return found + ([f"{self.orphans} processes outlived it"] if self.orphans else [])


def rear(
    arguments: list[str], folder: Path, log: Path, moment: Moment | None = None, fresh: bool = False
) -> Child:
    """Run a command of normalgan in a child, in a session of its own.

    Args:
        arguments: of the command.
        folder: where it writes.
        log: for what it says; beside it lies what it changes.
        moment: when it is killed; None lets it end by itself.
        fresh: whether it is a process that imports everything itself, as users start it.

    Raises:
        RuntimeError: if this process has threads, which a fork would lose, or the child hangs.
    """
    if len(list(Path("/proc/self/task").iterdir())) > 1:
        raise RuntimeError("this process has more than one thread; forking it is not safe")
    told = log.with_suffix(".changes")
    told.unlink(missing_ok=True)
    start = time.monotonic()
    pid = os.fork()
    if not pid:
        _live(arguments, folder, log, moment, fresh)
    status = _await(pid, folder, moment, start)
    seconds = time.monotonic() - start
    changes = told.read_text().splitlines() if told.exists() else []
    return Child(os.waitstatus_to_exitcode(status), log.read_text(), changes, seconds, _orphans(pid))


def _live(arguments: list[str], folder: Path, log: Path, moment: Moment | None, fresh: bool) -> None:
    """Be the child; never returns."""
    code = 70
    try:
        os.setsid()
        stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        if fresh:
            paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]  # the first: the diary
            os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
            os.execv(sys.executable, [sys.executable, "-m", "normalgan", *arguments])
        killed_at = (moment.change, moment.seconds) if moment else (0, 0.0)
        tell_changes(folder, log.with_suffix(".changes"), *killed_at)
        code = main(arguments)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)  # what the parent would tidy up at its end is not the child's


def _await(pid: int, folder: Path, moment: Moment | None, start: float) -> int:
    """Return a child's status, after killing it if that is for the parent to do."""
    at = None if moment is None or moment.change or moment.files else start + moment.seconds
    while True:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return status
        now = time.monotonic()
        if at is None and moment and moment.files and _files(folder) >= moment.files:
            at = now + moment.seconds
        if (at is not None and now >= at) or now > start + PATIENCE:
            os.kill(pid, signal.SIGKILL)
            _, status = os.waitpid(pid, 0)
            if now > start + PATIENCE:
                raise RuntimeError(f"a child was not done after {PATIENCE} seconds")
            return status
        time.sleep(TICK)


def _files(folder: Path) -> int:
    return sum(path.is_file() for path in folder.rglob("*"))


def _orphans(session: int) -> int:
    """Return how many processes of a session are left, after giving them half a minute to end."""
    deadline = time.monotonic() + 30
    while (left := sum(_is_in(pid, session) for pid in psutil.pids())) and time.monotonic() < deadline:
        time.sleep(0.05)
    return left


def _is_in(pid: int, session: int) -> bool:
    try:
        return os.getsid(pid) == session and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except (ProcessLookupError, psutil.NoSuchProcess):
        return False
