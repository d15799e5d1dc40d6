"""How every add-on calls `normalgan generate`: find the command, run it, and pass on what it says.

It is copied into each add-on and runs in the Python of its program, so it needs the standard library alone.
"""

import os
import shutil
import subprocess
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


class CommandError(Exception):
    """One sentence for the user: no command was found, or what the command said as it failed."""


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
            raise CommandError(f"normalgan was not found: {given} is no command; {REMEDY}")
    found = shutil.which("normalgan")
    if found is None:
        raise CommandError(f"normalgan was not found; {REMEDY}")
    return found


def predict(drawing: str | Path, output: str | Path, *settings: str, chosen: str = "") -> str:
    """Paint the normal map of one drawing.

    Args:
        drawing: its file.
        output: the map's file.
        settings: of `normalgan generate`.
        chosen: as of `find_command`.

    Returns:
        What the command warned of, or nothing.

    Raises:
        CommandError: with what the command said, if it failed, or if there is none.
    """
    command = [find_command(chosen), "generate", *settings, "-o", str(output), "--", str(drawing)]
    environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
    try:
        done = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise CommandError(f"normalgan could not be started: {command[0]}: {error.strerror}.") from error
    if done.returncode:
        said = done.stderr.strip() or f"normalgan failed without a word, with exit code {done.returncode}."
        raise CommandError(said)
    return "\n".join(line for line in done.stderr.splitlines() if "warning:" in line)
