"""The plug-in of Krita, in Krita without a window."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from add_ons import DOG, assert_normal_map, install, own_command, painted_by_hand, program, start
from PIL import Image

from needs import KRITA

SCRIPT = """import json
import os

from krita import InfoObject, Krita


def run(_arguments=None):
    from normalgan_krita import normal_layer
    from normalgan_krita.normalgan_command import CommandError

    document = Krita.instance().openDocument(os.environ["DRAWING"])
    document.setBatchmode(True)
    if os.environ.get("SPACE"):
        document.setColorSpace(*os.environ["SPACE"].split(","))
        document.waitForDone()
    node = document.topLevelNodes()[0]
    told = {}
    try:
        layer, told["warned"] = normal_layer(document, node)
    except CommandError as error:
        told["error"] = str(error)
    else:
        told["space"] = [layer.colorModel(), layer.colorDepth()]
        width, height = document.width(), document.height()
        with open("normals.raw", "wb") as file:
            file.write(bytes(layer.pixelData(0, 0, width, height)))
        document.saveAs(os.path.abspath("fox.kra"))
    told["layers"] = [node.name() for node in document.topLevelNodes()]
    with open("told.json", "w") as file:
        json.dump(told, file)
    document.close()
"""
COLOURS = "RGBA,U8,sRGB-elle-V2-srgbtrc.icc"


@pytest.fixture
def krita(tmp_path: Path) -> str:
    """Krita's runner of scripts, with the plug-in in its home."""
    found = program(KRITA, "kritarunner")
    install("krita", tmp_path, "--normalgan", str(own_command(tmp_path)))
    return found


def run(krita: str, home: Path, **environment: str) -> dict[str, Any]:
    """Run the plug-in on a drawing, and return what it did."""
    plugins = home / ".local" / "share" / "krita" / "pykrita"
    (plugins / "normalgan_run.py").write_text(SCRIPT, encoding="utf-8")
    places = {
        "PYTHONPATH": str(plugins),
        "QT_QPA_PLATFORM": "offscreen",
        "DRAWING": str(DOG),
        "SPACE": COLOURS,
    }
    done = start([krita, "-s", "normalgan_run", "-f", "run"], home, {**places, **environment})
    if "No module named 'PyQt5" in done.stderr:
        pytest.skip(KRITA.reason("its Python has no PyQt5"))
    assert (home / "told.json").exists(), done.stdout + done.stderr
    told: dict[str, Any] = json.loads((home / "told.json").read_text(encoding="utf-8"))
    return told


@pytest.mark.slow  # starts Krita
@pytest.mark.parametrize("space", [COLOURS, COLOURS.replace("U8", "U16")])
def test_the_map_is_a_layer_above_the_drawing(krita: str, tmp_path: Path, space: str) -> None:
    told = run(krita, tmp_path, SPACE=space)
    assert told["layers"] == ["Background", "Normal map"]  # from below
    assert told["space"] == ["RGBA", "U8"]
    by_hand = painted_by_hand(tmp_path / "normalgan", DOG, tmp_path / "hand.png", "--alpha")
    pixels = np.fromfile(tmp_path / "normals.raw", np.uint8).reshape(by_hand.shape)[..., [2, 1, 0, 3]]
    assert_normal_map(pixels)
    if "U8" in space:
        np.testing.assert_array_equal(pixels, by_hand)
    assert (tmp_path / "fox.kra").exists()


@pytest.mark.slow  # starts Krita
def test_without_normalgan_one_sentence_says_what_to_do(krita: str, tmp_path: Path) -> None:
    told = run(krita, tmp_path, NORMALGAN="/nowhere/normalgan")
    assert told["error"].startswith(
        "normalgan was not found: /nowhere/normalgan is not a command; install it"
    )
    assert told["layers"] == ["Background"]


@pytest.mark.slow  # starts Krita
def test_what_the_command_says_is_shown(krita: str, tmp_path: Path) -> None:
    Image.new("RGB", (64, 64), "white").save(tmp_path / "empty.png")
    told = run(krita, tmp_path, DRAWING=str(tmp_path / "empty.png"))
    assert told["error"].startswith("normalgan: ")
    assert len(told["error"].splitlines()) == 1


@pytest.mark.slow  # starts Krita
def test_a_grey_document_is_refused_with_what_to_do(krita: str, tmp_path: Path) -> None:
    told = run(krita, tmp_path, SPACE="")  # Krita opens a grey picture as grey
    assert told["error"] == "A normal map needs an RGB document: Image > Convert Image Color Space."
