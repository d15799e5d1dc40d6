#!/usr/bin/env python3
"""Installs an add-on in the folder where its program looks for it, with a note of normalgan's path.

    python integrations/install.py inkscape
    python integrations/install.py godot4 --to my_game/
    python integrations/install.py krita --normalgan ~/normalgan/.venv/bin/normalgan

The programs are inkscape, gimp3 (or gimp2 for GIMP 2.10), krita, blender, aseprite, godot4 (or godot3 for
Godot 3) and comfyui.

It needs only the standard library, and replaces the files of an earlier installation.
"""

import argparse
import os
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
COMMAND = "normalgan_command.py"


def program_folders(system: str, home: Path, environment: Mapping[str, str]) -> dict[str, Path]:
    """Return the folder, without its version, that holds each program's settings and user additions.

    Args:
        system: the system, as in `sys.platform`.
        home: the user's home folder.
        environment: the environment variables.
    """
    if system == "win32":
        data = Path(environment.get("APPDATA") or home / "AppData" / "Roaming")
        config, blender, inkscape = data, data / "Blender Foundation" / "Blender", data / "inkscape"
    elif system == "darwin":
        config = data = home / "Library" / "Application Support"
        blender, inkscape = data / "Blender", data / "org.inkscape.Inkscape" / "config" / "inkscape"
    else:
        config = Path(environment.get("XDG_CONFIG_HOME") or home / ".config")
        data = Path(environment.get("XDG_DATA_HOME") or home / ".local" / "share")
        blender, inkscape = config / "blender", config / "inkscape"
    aseprite = config / ("aseprite" if system.startswith("linux") else "Aseprite")
    return {
        "aseprite": aseprite,
        "blender": blender,
        "gimp": config / "GIMP",
        "inkscape": inkscape,
        "krita": data / "krita",
    }


PROGRAMS = program_folders(sys.platform, Path.home(), os.environ)


@dataclass(frozen=True)
class AddOn:
    """Where an add-on is installed, and how.

    Args:
        folder: the folder that the program reads; None if it does not exist yet or no usual one exists, in
            which case `--to` must name it.
        files: pairs of a path in the program's folder here and its path in `folder`.
        beside: the folder in `folder` for the note of the command's path, and for the module that calls the
            command from Python.
        python: whether the add-on calls the command from Python.
        then: the steps that remain for the user.
    """

    folder: Path | None
    files: tuple[tuple[str, str], ...]
    beside: str
    python: bool
    then: str


def newest(program: str, versions: str) -> Path | None:
    """Return the settings folder of the newest version of a program used here, or None."""
    used = [path for path in PROGRAMS[program].glob(versions) if path.name.replace(".", "").isdigit()]
    return max(used, key=lambda path: [int(part) for part in path.name.split(".")], default=None)


BLENDER, GIMP3 = newest("blender", "*.*"), newest("gimp", "3.*")

GIMP_THEN = "Restart GIMP: Filters > Map > Normal map of the drawing (normalgan)."
KRITA_THEN = "Settings > Configure Krita > Python Plugin Manager: enable it; restart Krita; Tools > Scripts."
GODOT_THEN = (
    "Project > Project Settings > Plugins: enable normalgan. Then choose it in the Import dock of a drawing."
)
ADD_ONS = {
    "inkscape": AddOn(
        PROGRAMS["inkscape"] / "extensions",
        (("normalgan_light.inx", "normalgan/"), ("normalgan_light.py", "normalgan/")),
        "normalgan",
        True,
        "Restart Inkscape: Extensions > Render > Normal map and light.",
    ),
    "godot3": AddOn(None, (("addons/normalgan", "addons/normalgan"),), "addons/normalgan", False, GODOT_THEN),
    "godot4": AddOn(None, (("addons/normalgan", "addons/normalgan"),), "addons/normalgan", False, GODOT_THEN),
    "blender": AddOn(
        BLENDER and BLENDER / "scripts" / "addons",
        (("normalgan_blender", "normalgan_blender"),),
        "normalgan_blender",
        True,
        "Edit > Preferences > Add-ons: enable normalgan. Then Add > Image > Drawing with Normal Map.",
    ),
    "gimp2": AddOn(
        PROGRAMS["gimp"] / "2.10" / "plug-ins",
        (("normalgan_gimp2.py", "normalgan_gimp2/"),),
        "normalgan_gimp2",
        True,
        GIMP_THEN,
    ),
    "gimp3": AddOn(
        (GIMP3 or PROGRAMS["gimp"] / "3.0") / "plug-ins",
        (("normalgan_gimp3.py", "normalgan_gimp3/"),),
        "normalgan_gimp3",
        True,
        GIMP_THEN,
    ),
    "krita": AddOn(
        PROGRAMS["krita"] / "pykrita",
        (("normalgan_krita", "normalgan_krita"), ("normalgan_krita.desktop", "")),
        "normalgan_krita",
        True,
        KRITA_THEN,
    ),
    "aseprite": AddOn(
        PROGRAMS["aseprite"] / "scripts",
        (("normalgan.lua", ""),),
        "",
        False,
        "File > Scripts > Rescan Scripts Folder: normalgan.",
    ),
    "comfyui": AddOn(
        None,
        (("normalgan_nodes", "normalgan_nodes"),),
        "normalgan_nodes",
        False,
        "Install normalgan into ComfyUI's own Python, and restart ComfyUI.",
    ),
}


def install(name: str, folder: Path, normalgan: str) -> None:
    """Copy the files of an add-on.

    Args:
        name: the name of the add-on.
        folder: the folder that its program reads.
        normalgan: the path of the command; if empty, the add-on looks for it on every call.
    """
    add_on = ADD_ONS[name]
    for source, target in add_on.files:
        start = HERE / name / source
        goal = folder / target
        if not target or target.endswith("/"):
            goal = goal / start.name
        goal.parent.mkdir(parents=True, exist_ok=True)
        if start.is_dir():
            shutil.rmtree(goal, ignore_errors=True)
            shutil.copytree(start, goal, ignore=shutil.ignore_patterns("__pycache__", COMMAND))
        else:
            shutil.copy(start, goal)
    beside = folder / add_on.beside
    if add_on.python:
        shutil.copy(HERE / COMMAND, beside / COMMAND)
    note = beside / "normalgan_path.txt"
    if normalgan:
        note.write_text(f"{normalgan}\n", encoding="utf-8")
    else:
        note.unlink(missing_ok=True)


def own_command() -> str:
    """Return the command in this clone's environment or on the search path, or an empty text."""
    for path in (
        HERE.parent / ".venv" / "bin" / "normalgan",
        HERE.parent / ".venv" / "Scripts" / "normalgan.exe",
    ):
        if path.exists():
            return str(path)
    return shutil.which("normalgan") or ""


def main() -> int:
    """Install the add-on that the command line names."""
    parser = argparse.ArgumentParser(description="Install an add-on for a program.")
    parser.add_argument("name", choices=sorted(ADD_ONS), help="the program")
    parser.add_argument("--to", type=Path, help="the target folder, if not the program's usual one")
    parser.add_argument(
        "--normalgan", default="", help="the command, by default that of this clone or the search path"
    )
    given = parser.parse_args()
    folder = given.to or ADD_ONS[given.name].folder
    if folder is None:
        parser.error(f"the add-on for {given.name} needs a folder: name it with --to")
    found = shutil.which(given.normalgan) if given.normalgan else own_command()
    if given.normalgan and not found:
        parser.error(f"{given.normalgan} is not a command; give the path of normalgan")
    normalgan = str(Path(found).absolute()) if found else ""  # the program's working directory differs
    try:
        install(given.name, folder, normalgan)
    except OSError as error:
        parser.error(f"{error.filename or folder} cannot be written: {error.strerror}")
    print(f"Installed in {folder}. {ADD_ONS[given.name].then}")
    if not normalgan:
        print("normalgan itself was not found; install it and run this again.", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
