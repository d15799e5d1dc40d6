"""Calls `normalgan generate` for every add-on: finds the command, runs it, and passes on its messages.

It is copied into each add-on and runs in the program's Python, so it needs only the standard library.
"""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

RECORD = Path(__file__).with_name("normalgan_path.txt")
"""The file where `install.py` notes the command: programs started from a menu see no active environment."""

FOREIGN = ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH")
"""Variables that programs set for their own Python, and that break another Python."""

REMEDY = (
    "install it and run integrations/install.py again, or set the environment variable NORMALGAN to the path "
    "of its command."
)
"""The advice to the user when no command is found."""


NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)
"""On Windows, a command started from a program without a console would open one."""

PAUSE = 0.05
"""Seconds between two checks whether the command has ended; the program stays usable meanwhile."""


class CommandError(Exception):
    """One sentence for the user: that no command was found, or the command's error message."""


class CancelledError(CommandError):
    """The user has cancelled, so there is nothing to report."""


def find_command(chosen: str = "") -> str:
    """Return the path of the command.

    Args:
        chosen: the path that the user set in the program, or empty. If it is empty, the environment variable
            NORMALGAN, the installer's note and the search path follow in this order.

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
    """A running command that predicts the normal map of one drawing while the program continues.

    Args:
        drawing: the file of the drawing.
        output: the file for the map.
        settings: settings of `normalgan generate`.
        chosen: as in `find_command`.

    Raises:
        CommandError: if there is no command, or it cannot be started.
    """

    def __init__(self, drawing: str | Path, output: str | Path, *settings: str, chosen: str = "") -> None:
        command = [find_command(chosen), "generate", *settings, "-o", str(output), "--", str(drawing)]
        environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
        # Not a pipe: nobody reads it while the command runs, and a full pipe would block the command.
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
        """Whether the command has ended, successfully or not."""
        return self._process.poll() is not None

    def cancel(self) -> None:
        """End the command, which writes a file completely or not at all."""
        self._process.kill()
        self._process.wait()
        self._said.close()

    def result(self) -> str:
        """Wait for the end of the command, and return its warnings, or an empty text.

        Raises:
            CommandError: if the command failed, with its message.
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
        drawing: the file of the drawing.
        output: the file for the map.
        settings: settings of `normalgan generate`.
        chosen: as in `find_command`.
        meanwhile: called repeatedly until the command ends; it lets the program work, and returns whether to
            continue.

    Returns:
        The command's warnings, or an empty text.

    Raises:
        CancelledError: if ``meanwhile`` returns False.
        CommandError: if there is no command, or it failed; then with its message.
    """
    running = Running(drawing, output, *settings, chosen=chosen)
    while meanwhile is not None and not running.ended:
        if not meanwhile():
            running.cancel()
            raise CancelledError("cancelled")
        time.sleep(PAUSE)
    return running.result()
