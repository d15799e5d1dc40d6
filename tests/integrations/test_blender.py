"""The add-on of Blender, in Blender without a window."""

from pathlib import Path

import numpy as np
import pytest
from add_ons import FOX, install, own_command, program, start
from numpy.typing import NDArray
from PIL import Image

from needs import BLENDER
from normalgan.inference.outputs.engines import sidecar

SCENE = """import math
import os
import sys

import bpy

drawing = sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="normalgan_blender")
assert bpy.ops.normalgan.drawing(filepath=drawing) == {"FINISHED"}
made = bpy.context.active_object
(image,) = [image for image in bpy.data.images if image.name.endswith("_normal.png")]
assert image.colorspace_settings.name == "Non-Color" and image.packed_file is not None
(normal,) = [n for n in made.active_material.node_tree.nodes if n.type == "NORMAL_MAP"]
assert normal.outputs["Normal"].links[0].to_node.type == "BSDF_PRINCIPLED"

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 8, False
scene.render.resolution_x = scene.render.resolution_y = 160
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 2, (0, 0, 3)
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy = 3
for thing in (camera, sun):
    scene.collection.objects.link(thing)
scene.camera = camera
for name, angle in (("above", -60), ("below", 60)):
    sun.rotation_euler = (math.radians(angle), 0, 0)
    scene.render.filepath = os.path.join(os.getcwd(), f"{name}.png")
    bpy.ops.render.render(write_still=True)
"""
FAILING = """import sys

import bpy

bpy.ops.preferences.addon_enable(module="normalgan_blender")
try:
    bpy.ops.normalgan.drawing(filepath=sys.argv[-1])
except RuntimeError as error:
    print(f"SHOWN {error}")
assert not bpy.data.materials.get("fox")
"""

SPACE = """import sys

import bpy

exec(compile(open(sys.argv[-1]).read(), sys.argv[-1], "exec"), {"__file__": sys.argv[-1]})
print("SPACE", bpy.data.images["fox_normal.png"].colorspace_settings.name)
"""
OCIO = """ocio_profile_version: 2
roles: {%s, default: Texture, scene_linear: ACEScg, color_picking: Texture}
displays:
  sRGB: [!<View> {name: Standard, colorspace: Texture}]
colorspaces:
  - !<ColorSpace> {name: ACEScg}
  - !<ColorSpace> {name: Texture, to_reference: !<ExponentTransform> {value: [2.2, 2.2, 2.2, 1]}}
  - !<ColorSpace> {name: Numbers, isdata: true}
  - !<ColorSpace> {name: Raw, isdata: true}
"""


@pytest.fixture
def blender(tmp_path: Path) -> list[str]:
    """The start of a command line: Blender with the add-on where it looks for one."""
    found = program(BLENDER, "blender")
    scripts = tmp_path / "scripts"
    script = own_command(tmp_path)
    install("blender", tmp_path, "--to", str(scripts / "addons"), "--normalgan", str(script))
    return [found, "-b", "--factory-startup", "--python-exit-code", "3"]


def run(blender: list[str], home: Path, source: str, drawing: Path, **environment: str) -> str:
    """Run Python in Blender, and return what was printed."""
    (home / "run.py").write_text(source, encoding="utf-8")
    places = {"BLENDER_USER_SCRIPTS": str(home / "scripts"), **environment}
    done = start([*blender, "-P", str(home / "run.py"), "--", str(drawing)], home, places)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return done.stdout


def grey(picture: Path) -> NDArray[np.float64]:
    """Return a picture as grey."""
    with Image.open(picture) as image:
        return np.asarray(image.convert("L"), dtype=np.float64)


@pytest.mark.slow  # renders with Cycles
def test_a_drawing_becomes_a_plane_lit_from_where_the_lamp_is(blender: list[str], tmp_path: Path) -> None:
    run(blender, tmp_path, SCENE, FOX)
    above, below = grey(tmp_path / "above.png"), grey(tmp_path / "below.png")
    back, belly = np.s_[25:55, 50:125], np.s_[75:95, 60:125]
    assert above[back].mean() > below[back].mean() + 20
    assert above[belly].mean() < below[belly].mean() - 20
    assert above[:3].max() < 5  # clear where there is no object


@pytest.mark.slow  # starts Blender
def test_without_normalgan_one_sentence_says_what_to_do(blender: list[str], tmp_path: Path) -> None:
    said = run(blender, tmp_path, FAILING, FOX, NORMALGAN="/nowhere/normalgan")
    assert "SHOWN Error: normalgan was not found: /nowhere/normalgan is not a command; install it" in said


@pytest.mark.slow  # starts Blender
def test_what_the_command_says_is_shown(blender: list[str], tmp_path: Path) -> None:
    said = run(blender, tmp_path, FAILING, tmp_path / "missing.png")
    assert "SHOWN Error: normalgan: no sketch found at" in said


@pytest.mark.slow  # starts Blender
@pytest.mark.parametrize(
    ("roles", "space"), [("data: Numbers, rendering: ACEScg", "Numbers"), ("rendering: ACEScg", "Raw")]
)
def test_a_map_is_numbers_under_any_colour_configuration(
    blender: list[str], tmp_path: Path, roles: str, space: str
) -> None:
    (tmp_path / "config.ocio").write_text(OCIO % roles)
    Image.new("RGB", (4, 4)).save(tmp_path / "fox_normal.png")
    script, content = sidecar("blender", tmp_path / "fox_normal.png")
    script.write_bytes(content)
    said = run(blender, tmp_path, SPACE, script, OCIO=str(tmp_path / "config.ocio"))
    assert f"SPACE {space}\n" in said
