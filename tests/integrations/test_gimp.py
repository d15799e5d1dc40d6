"""The plug-in of GIMP, in GIMP without a window."""

from pathlib import Path

import numpy as np
import pytest
from add_ons import DOG, assert_normal_map, install, own_command, painted_by_hand, program, start
from PIL import Image

from needs import GIMP

BATCH = """(let* ((image (car (gimp-image-new 300 280 RGB)))
       (drawing (car (gimp-file-load-layer RUN-NONINTERACTIVE image "{drawing}"))))
  (gimp-image-insert-layer image drawing 0 0)
  (gimp-layer-set-offsets drawing 30 20)
  (let* ((normals (car (plug-in-normalgan-layer RUN-NONINTERACTIVE image drawing 1.0)))
         (at (gimp-drawable-offsets normals)))
    (gimp-message (string-append (car (gimp-item-get-name normals))
      " at " (number->string (car at)) " " (number->string (cadr at))
      " of " (number->string (car (gimp-image-get-layers image)))
      " place " (number->string (car (gimp-image-get-item-position image normals)))))
    (file-png-save RUN-NONINTERACTIVE image normals "normals.png" "n" 0 9 0 0 0 0 0)))"""


@pytest.fixture
def gimp(tmp_path: Path) -> str:
    """GIMP with the plug-in in its home."""
    found = program(GIMP, "gimp-console", "gimp-console-2.10")
    install("gimp", tmp_path, "--normalgan", str(own_command(tmp_path)))
    return found


def run(gimp: str, home: Path, drawing: Path, **environment: str) -> str:
    """Run the plug-in on a layer, and return what GIMP says."""
    batch = BATCH.format(drawing=drawing)
    done = start([gimp, "-i", "-d", "-f", "-b", batch, "-b", "(gimp-quit 0)"], home, environment)
    return done.stdout + done.stderr


@pytest.mark.slow  # starts GIMP
def test_the_map_is_a_layer_above_the_drawing_and_where_it_is(gimp: str, tmp_path: Path) -> None:
    said = run(gimp, tmp_path, DOG)
    assert "Normal map at 30 20 of 2 place 0" in said
    with Image.open(tmp_path / "normals.png") as image:
        predicted = np.asarray(image)
    assert_normal_map(predicted)
    by_hand = painted_by_hand(tmp_path / "normalgan", DOG, tmp_path / "hand.png", "--alpha")
    assert np.abs(predicted.astype(int) - by_hand.astype(int)).max() <= 1


@pytest.mark.slow  # starts GIMP
def test_without_normalgan_one_sentence_says_what_to_do(gimp: str, tmp_path: Path) -> None:
    said = run(gimp, tmp_path, DOG, NORMALGAN="/nowhere/normalgan")
    assert "normalgan was not found: /nowhere/normalgan is not a command; install it" in said
    assert "Traceback" not in said


@pytest.mark.slow  # starts GIMP
def test_what_the_command_says_is_shown(gimp: str, tmp_path: Path) -> None:
    Image.new("RGB", (64, 64), "white").save(tmp_path / "empty.png")
    said = run(gimp, tmp_path, tmp_path / "empty.png")
    assert "normalgan: " in said
    assert "Traceback" not in said
