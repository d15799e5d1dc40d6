"""The plug-ins of GIMP 2.10 and GIMP 3, in GIMP without a window."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from add_ons import DOG, assert_normal_map, install, own_command, painted_by_hand, program, start
from PIL import Image

from needs import GIMP2, GIMP3

SCRIPT_FU = """(let* ((image (car (gimp-image-new 300 280 RGB)))
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

PYTHON_FU = """
from gi.repository import Gimp, Gio
alone = Gimp.RunMode.NONINTERACTIVE
image = Gimp.Image.new(300, 280, Gimp.ImageBaseType.RGB)
drawing = Gimp.file_load_layer(alone, image, Gio.File.new_for_path("{drawing}"))
image.insert_layer(drawing, None, 0)
drawing.set_offsets(30, 20)
config = Gimp.get_pdb().lookup_procedure("plug-in-normalgan-layer").create_config()
config.set_property("image", image)
config.set_core_object_array("drawables", [drawing])
done = Gimp.get_pdb().lookup_procedure("plug-in-normalgan-layer").run(config)
if done.index(0) != Gimp.PDBStatusType.SUCCESS:
    print(Gimp.get_pdb().get_last_error())
else:
    normals = done.index(1)
    _, x, y = normals.get_offsets()
    place = image.get_item_position(normals)
    print(f"{{normals.get_name()}} at {{x}} {{y}} of {{len(image.get_layers())}} place {{place}}")
    alone_in = Gimp.Image.new(normals.get_width(), normals.get_height(), Gimp.ImageBaseType.RGB)
    layer = Gimp.Layer.new_from_drawable(normals, alone_in)
    alone_in.insert_layer(layer, None, 0)
    layer.set_offsets(0, 0)
    export = Gimp.get_pdb().lookup_procedure("file-png-export")
    config = export.create_config()
    for name, value in (("run-mode", alone), ("image", alone_in), ("save-transparent", True)):
        config.set_property(name, value)
    config.set_property("file", Gio.File.new_for_path("normals.png"))
    export.run(config)
"""


class Gimp(NamedTuple):
    """A version of GIMP with the plug-in in its home: how it is started, and what it is given."""

    command: list[str]
    batch: str


@pytest.fixture(params=["gimp2", "gimp3"])
def gimp(request: pytest.FixtureRequest, tmp_path: Path) -> Gimp:
    install(request.param, tmp_path, "--normalgan", str(own_command(tmp_path)))
    if request.param == "gimp2":
        return Gimp([program(GIMP2, "gimp-console-2.10"), "-i", "-d", "-f"], SCRIPT_FU)
    found = program(GIMP3, "gimp-console-3.2", "gimp-console-3.0")
    version = found.rpartition("-")[2]
    plug_ins = tmp_path / ".config" / "GIMP"
    (plug_ins / "3.0").rename(plug_ins / version)
    return Gimp([found, "-i", "-d", "-f", "--batch-interpreter=python-fu-eval"], PYTHON_FU)


def run(gimp: Gimp, home: Path, drawing: Path, **environment: str) -> str:
    """Run the plug-in on a layer, and return what GIMP says."""
    batch = gimp.batch.format(drawing=drawing)
    ended = ["-b", "(gimp-quit 0)"] if gimp.batch is SCRIPT_FU else ["--quit"]
    done = start([*gimp.command, "-b", batch, *ended], home, environment)
    return done.stdout + done.stderr


@pytest.mark.slow  # starts GIMP
def test_the_map_is_a_layer_above_the_drawing_and_where_it_is(gimp: Gimp, tmp_path: Path) -> None:
    said = run(gimp, tmp_path, DOG)
    assert "Normal map at 30 20 of 2 place 0" in said
    with Image.open(tmp_path / "normals.png") as image:
        predicted = np.asarray(image)
    assert_normal_map(predicted)
    by_hand = painted_by_hand(tmp_path / "normalgan", DOG, tmp_path / "hand.png", "--alpha")
    assert np.abs(predicted.astype(int) - by_hand.astype(int)).max() <= 1


@pytest.mark.slow  # starts GIMP
def test_without_normalgan_one_sentence_says_what_to_do(gimp: Gimp, tmp_path: Path) -> None:
    said = run(gimp, tmp_path, DOG, NORMALGAN="/nowhere/normalgan")
    assert "normalgan was not found: /nowhere/normalgan is not a command; install it" in said
    assert "Traceback" not in said


@pytest.mark.slow  # starts GIMP
def test_what_the_command_says_is_shown(gimp: Gimp, tmp_path: Path) -> None:
    Image.new("RGB", (64, 64), "white").save(tmp_path / "empty.png")
    said = run(gimp, tmp_path, tmp_path / "empty.png")
    assert "normalgan: " in said
    assert "Traceback" not in said
