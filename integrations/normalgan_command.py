"""How every add-on calls `normalgan generate`: find the command, run it, and pass on what it says.

It is copied into each add-on and runs in the Python of its program, so it needs the standard library alone.
"""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

RECORD = Path(__file__).with_name("normalgan_path.txt")
"""Where `install.py` notes the command: a program started from a menu does not see an active environment."""

FOREIGN = ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH")
"""What programs set for a Python of their own, and what breaks another one."""

REMEDY = (
    "install it and run integrations/install.py again, or set the environment variable NORMALGAN to the path "
    "of its command."
)
"""What to do where no command is found."""


NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)
"""On Windows, a command that is started from a program without a console would open one."""

PAUSE = 0.05
"""Seconds between two looks at whether the command has ended: the program stays usable."""


class CommandError(Exception):
    """One sentence for the user: no command was found, or what the command said as it failed."""


class CancelledError(CommandError):
    """The user has cancelled; nothing is left to be said."""


def find_command(chosen: str = "") -> str:
    """Return the path of the command.

    Args:
        chosen: one that the user set in the program, or nothing. After it come the environment variable
            NORMALGAN, what the installer noted, and the search path.

    Raises:
        CommandError: if there is none.
    """
    noted = RECORD.read_text(encoding="utf-8").strip() if RECORD.exists() else ""
    for given in (chosen, os.environ.get("NORMALGAN", ""), noted):
        found = shutil.which(given) if given else None
        if found:
            return found
        if given:
            raise CommandError(f"normalgan was not found: {given} is not a command; {REMEDY}")
    found = shutil.which("normalgan")
    if found is None:
        raise CommandError(f"normalgan was not found; {REMEDY}")
    return found


class Running:
    """A command that predicts the normal map of one drawing, while its program goes on.

    Args:
        drawing: its file.
        output: the map's file.
        settings: of `normalgan generate`.
        chosen: as of `find_command`.

    Raises:
        CommandError: if there is no command, or it cannot be started.
    """

    def __init__(self, drawing: str | Path, output: str | Path, *settings: str, chosen: str = "") -> None:
        command = [find_command(chosen), "generate", *settings, "-o", str(output), "--", str(drawing)]
        environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
        # Not a pipe: nobody reads it while the command runs, and a full one would stop it.
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - it is closed with the result
        try:
            self._process = subprocess.Popen(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._said,
                creationflags=NO_WINDOW,
            )
        except OSError as error:
            self._said.close()
            raise CommandError(f"normalgan could not be started: {command[0]}: {error.strerror}.") from error

    @property
    def ended(self) -> bool:
        """Whether it has ended, in whatever way."""
        return self._process.poll() is not None

    def cancel(self) -> None:
        """End it; it writes a file completely or not at all."""
        self._process.kill()
        self._process.wait()
        self._said.close()

    def result(self) -> str:
        """Wait until it ends, and return what it warned of, or nothing.

        Raises:
            CommandError: with what it said, if it failed.
        """
        code = self._process.wait()
        with self._said:
            self._said.seek(0)
            words = self._said.read().decode("utf-8", "replace")
        if code:
            said = words.strip() or f"normalgan failed without a word, with exit code {code}."
            raise CommandError(said)
        return "\n".join(line for line in words.splitlines() if "warning:" in line)


def predict(
    drawing: str | Path,
    output: str | Path,
    *settings: str,
    chosen: str = "",
    meanwhile: Callable[[], bool] | None = None,
) -> str:
    """Predict the normal map of one drawing.

    Args:
        drawing: its file.
        output: the map's file.
        settings: of `normalgan generate`.
        chosen: as of `find_command`.
        meanwhile: called again and again until the command ends; it lets the program work, and returns
            whether to go on.

    Returns:
        What the command warned of, or nothing.

    Raises:
        CancelledError: if ``meanwhile`` says so.
        CommandError: with what the command said, if it failed, or if there is none.
    """
    running = Running(drawing, output, *settings, chosen=chosen)
    while meanwhile is not None and not running.ended:
        if not meanwhile():
            running.cancel()
            raise CancelledError("cancelled")
        time.sleep(PAUSE)
    return running.result()
