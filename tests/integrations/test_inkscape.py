"""The add-on of Inkscape, in Inkscape."""

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from add_ons import assert_normal_map, install, own_command, program, start
from numpy.typing import NDArray
from PIL import Image

from needs import INKSCAPE

CUP = """<svg xmlns="http://www.w3.org/2000/svg" width="300" height="240" viewBox="0 0 300 240">
<g fill="none" stroke="#222" stroke-width="3"><ellipse cx="130" cy="60" rx="70" ry="18"/>
<path d="M60 60 C60 200 90 220 130 220 C170 220 200 200 200 60"/></g></svg>"""
INKEX = "/usr/share/inkscape/extensions"
SCRIPT = ".config/inkscape/extensions/normalgan/normalgan_light.py"


@pytest.fixture
def inkscape(tmp_path: Path) -> str:
    """Inkscape with the add-on and a drawing in its home."""
    found = program(INKSCAPE, "inkscape")
    program(INKSCAPE, "xvfb-run")
    install("inkscape", tmp_path, "--normalgan", str(own_command(tmp_path)))
    (tmp_path / "cup.svg").write_text(CUP, encoding="utf-8")
    return found


def run_script(home: Path, *arguments: str, **environment: str) -> tuple[int, str, str]:
    """Run the script as Inkscape does, which shows in a dialogue what it says and waits for a click."""
    command = ["/usr/bin/python3", str(home / SCRIPT), *arguments, str(home / "cup.svg")]
    done = start(command, home, {"PYTHONPATH": INKEX, **environment})
    return done.returncode, done.stdout, done.stderr


def rendered(inkscape: str, home: Path, drawing: str) -> NDArray[np.float64]:
    """Return the picture that Inkscape makes of an SVG, as grey."""
    (home / "lit.svg").write_text(drawing, encoding="utf-8")
    done = start([inkscape, "lit.svg", "-o", "lit.png", "-w", "300"], home)
    assert done.returncode == 0, done.stderr
    with Image.open(home / "lit.png") as image:
        return np.asarray(image.convert("RGBA").convert("L"), dtype=np.float64)


@pytest.mark.slow  # starts Inkscape's window
def test_inkscape_runs_it_on_an_open_drawing(inkscape: str, tmp_path: Path) -> None:
    actions = "org.normalgan.light.noprefs;export-filename:out.svg;export-do"
    done = start(
        [inkscape, "cup.svg", "--batch-process", f"--actions={actions}"],
        tmp_path,
        {"GDK_BACKEND": "x11"},
        screen=True,
    )
    assert done.returncode == 0, done.stderr
    saved = (tmp_path / "out.svg").read_text(encoding="utf-8")
    assert "feColorMatrix" in saved
    assert saved.index("<image") < saved.index("<ellipse")  # below the lines
    (map_,) = re.findall(r'href="data:image/png;base64,([^"]+)"', saved)
    with Image.open(io.BytesIO(base64.b64decode(map_))) as image:
        assert image.size == (1024, 819)
        assert_normal_map(np.asarray(image))


@pytest.mark.slow  # Inkscape is started four times
def test_light_comes_from_where_it_is_said_and_is_replaced(inkscape: str, tmp_path: Path) -> None:
    inside = {}
    for azimuth in ("180", "0"):
        code, drawing, said = run_script(tmp_path, "--azimuth", azimuth, "--size", "300")
        assert code == 0, said
        (tmp_path / "cup.svg").write_text(drawing, encoding="utf-8")  # the second lights the first's result
        assert drawing.count("<image") == 1
        grey = rendered(inkscape, tmp_path, drawing)
        inside[azimuth] = grey[120:170, 75:95].mean() - grey[120:170, 160:180].mean()
    assert inside["180"] > 30
    assert inside["0"] < -30


@pytest.mark.slow
def test_the_map_alone(inkscape: str, tmp_path: Path) -> None:
    drawings = []
    for form in ("predicted", "flat"):
        code, drawing, said = run_script(tmp_path, "--show", "map", "--size", "200", "--form", form)
        assert code == 0, said
        assert "feColorMatrix" not in drawing
        drawings.append(drawing)
    assert drawings[0] != drawings[1]


def test_without_normalgan_one_sentence_says_what_to_do(inkscape: str, tmp_path: Path) -> None:
    code, _, said = run_script(tmp_path, NORMALGAN="/nowhere/normalgan")
    assert code != 0
    assert said.strip() == (
        "normalgan was not found: /nowhere/normalgan is not a command; install it and run "
        "integrations/install.py again, or set the environment variable NORMALGAN to the path of its command."
    )


@pytest.mark.slow
def test_what_the_command_says_is_shown(inkscape: str, tmp_path: Path) -> None:
    empty = '<svg xmlns="http://www.w3.org/2000/svg" width="300" height="240"/>'
    (tmp_path / "cup.svg").write_text(empty, encoding="utf-8")
    code, _, said = run_script(tmp_path)
    assert code != 0
    assert said.startswith("normalgan: ")
    assert len(said.strip().splitlines()) == 1
