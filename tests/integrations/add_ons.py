"""What the tests of all add-ons share: a command of this checkout, programs, what a normal map must be."""

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from needs import Need

ROOT = Path(__file__).parents[2]
DOG = ROOT / "examples" / "sketches" / "dog.png"
FOX = ROOT / "examples" / "sketches" / "fox.png"
PATIENCE = 800  # seconds for a program to do its work; one that waits for a click would wait for ever


def own_command(folder: Path) -> Path:
    """Write a script that runs the normalgan of this checkout, wherever and by whomever it is started."""
    if sys.platform == "win32":
        script = folder / "normalgan.cmd"
        source = f'@set "PYTHONPATH={ROOT / "src"}"\n@"{sys.executable}" -m normalgan %*\n'
        script.write_text(source, encoding="utf-8")
        return script
    script = folder / "normalgan"
    source = f"PYTHONPATH='{ROOT / 'src'}' exec '{sys.executable}' -m normalgan \"$@\""
    script.write_text(f"#!/bin/sh\n{source}\n", encoding="utf-8")
    script.chmod(0o755)
    return script


def program(need: Need, *names: str) -> str:
    """Return the first program of these that is installed, or skip."""
    for name in names:
        if found := shutil.which(name):
            return found
    pytest.skip(need.reason(f"there is no {' and no '.join(names)}"))


def install(name: str, home: Path, *more: str) -> str:
    """Install an add-on as its user would, and return what was said."""
    done = subprocess.run(
        [sys.executable, ROOT / "integrations" / "install.py", name, *more],
        env={**os.environ, "HOME": str(home), "XDG_CONFIG_HOME": "", "XDG_DATA_HOME": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def start(
    command: list[str], home: Path, environment: Mapping[str, str] | None = None, *, screen: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a program in a home of its own, on a screen in memory if it needs one, and not for ever."""
    timed = [shutil.which("timeout") or "timeout", "--kill-after=5", str(PATIENCE), *command]
    if screen:
        timed = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24 -nolisten tcp", *timed]
    kept: Mapping[str, str] = {name: value for name, value in os.environ.items() if name != "NORMALGAN"}
    places = {"HOME": str(home), "XDG_CONFIG_HOME": "", "XDG_DATA_HOME": "", "XDG_RUNTIME_DIR": str(home)}
    done = subprocess.run(
        timed,
        env={**kept, **places, "DISPLAY": "", "LC_ALL": "C.UTF-8", **(environment or {})},
        cwd=home,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    assert done.returncode not in (124, 137), f"{command[0]} did not end: {done.stdout}{done.stderr}"
    return done


def painted_by_hand(script: Path, drawing: Path, output: Path, *settings: str) -> NDArray[np.uint8]:
    """Return what the command itself paints."""
    subprocess.run([script, "generate", *settings, "-o", output, "--", drawing], check=True)
    with Image.open(output) as image:
        return np.asarray(image)


def assert_normal_map(colours: NDArray[np.uint8], covered: float = 0.1) -> None:
    """Check that a picture holds unit normals of more than one direction on an object of some size."""
    normals = colours[..., :3].astype(np.float64) / 255 * 2 - 1
    tilted = np.hypot(normals[..., 0], normals[..., 1]) > 0.1
    assert tilted.mean() > covered
    lengths = np.linalg.norm(normals[tilted], axis=-1)
    assert np.abs(lengths - 1).max() < 0.05
    assert (normals[..., 2][tilted] > -0.05).all()
    assert normals[..., :2][tilted].std(axis=0).min() > 0.1
