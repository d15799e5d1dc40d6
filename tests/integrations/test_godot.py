"""The importers of Godot, each in its Godot; that of Godot 4 by its grammar too, as many machines lack it."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from add_ons import FOX, ROOT, install, own_command, program, start
from numpy.typing import NDArray
from PIL import Image

from needs import GODOT3, GODOT4
from normalgan.__main__ import main

PROJECT = """config_version=4

[application]
config/name="lit"

[display]
window/size/width=320
window/size/height=320

[editor_plugins]
enabled=PoolStringArray( "normalgan" )
"""
IMPORT = """[remap]
importer="normalgan"
type="PackedScene"
[deps]
source_file="res://fox.png"
[params]
strength=1.0
cut_out=true
"""
LIT = """extends SceneTree
# The imported drawing under one light, as a picture.

func _init():
	var fox = load("res://fox.png").instance()
	fox.centered = false
	fox.scale = Vector2(320, 320) / fox.texture.get_size()
	root.add_child(fox)
	var dark = CanvasModulate.new()
	dark.color = Color(0.25, 0.25, 0.3)
	root.add_child(dark)
	var white = Image.new()
	white.create(64, 64, false, Image.FORMAT_RGBA8)
	white.fill(Color(1, 0.9, 0.75))
	var light = Light2D.new()
	light.texture = ImageTexture.new()
	light.texture.create_from_image(white)
	light.texture_scale = 40
	light.range_height = 60
	light.position = Vector2(160, -200 if "above" in OS.get_cmdline_args() else 520)
	root.add_child(light)
	call_deferred("shoot")

func shoot():
	for frame in range(6):
		yield(self, "idle_frame")
	var shot = root.get_texture().get_data()
	shot.flip_y()
	shot.save_png("res://shot.png")
	quit()
"""

PROJECT_4 = """config_version=5

[application]
config/name="lit"

[display]
window/size/viewport_width=320
window/size/viewport_height=320

[editor_plugins]
enabled=PackedStringArray("res://addons/normalgan/plugin.cfg")

[rendering]
renderer/rendering_method="gl_compatibility"
"""
IMPORT_4 = IMPORT.replace("PackedScene", "CanvasTexture")
LIT_4 = """extends SceneTree
## The imported drawing under one light, as a picture.

func _initialize() -> void:
	var fox := Sprite2D.new()
	fox.texture = load("res://fox.png")
	fox.centered = false
	fox.scale = Vector2(320, 320) / fox.texture.get_size()
	root.add_child(fox)
	var dark := CanvasModulate.new()
	dark.color = Color(0.25, 0.25, 0.3)
	root.add_child(dark)
	var white := Image.create(64, 64, false, Image.FORMAT_RGBA8)
	white.fill(Color(1, 0.9, 0.75))
	var light := PointLight2D.new()
	light.texture = ImageTexture.create_from_image(white)
	light.texture_scale = 40
	light.height = 60
	light.position = Vector2(160, -200 if "above" in OS.get_cmdline_user_args() else 520)
	root.add_child(light)
	shoot()

func shoot() -> void:
	for frame in range(6):
		await process_frame
	root.get_texture().get_image().save_png("res://shot.png")
	quit()
"""
BACK, BELLY = np.s_[50:110, 100:250], np.s_[150:190, 120:250]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project of Godot 3 with the add-on and a drawing that is to be imported by it."""
    program(GODOT3, "godot3-server")
    folder = tmp_path / "game"
    folder.mkdir()
    script = own_command(tmp_path)
    install("godot3", tmp_path, "--to", str(folder), "--normalgan", str(script))
    (folder / "project.godot").write_text(PROJECT, encoding="utf-8")
    (folder / "fox.png").write_bytes(FOX.read_bytes())
    (folder / "fox.png.import").write_text(IMPORT, encoding="utf-8")
    (folder / "lit.gd").write_text(LIT, encoding="utf-8")
    return folder


def imported(project: Path, **environment: str) -> str:
    """Open the project in the editor without a window, which imports, and return what was said."""
    editor = ["godot3-server", "--path", str(project), "--editor", "--quit"]
    done = start(editor, project.parent, environment)
    return done.stdout + done.stderr


def lit(project: Path, where: str) -> NDArray[np.float64]:
    """Return the scene with its light above or below, as grey."""
    player = ["godot3", "--audio-driver", "Dummy", "--video-driver", "GLES2", "--path", str(project)]
    environment = {"LIBGL_ALWAYS_SOFTWARE": "1"}
    done = start([*player, "-s", "lit.gd", where], project.parent, environment, screen=True)
    with Image.open(project / "shot.png") as image:
        assert image.size == (320, 320), done.stderr
        return np.asarray(image.convert("L"), dtype=np.float64)


@pytest.mark.slow  # starts Godot three times
def test_an_imported_drawing_is_lit_from_where_the_light_is(project: Path) -> None:
    program(GODOT3, "godot3")
    program(GODOT3, "xvfb-run")
    said = imported(project)
    assert list((project / ".import").glob("fox.png-*.scn")), said
    assert not list((project / ".import").glob("*.normal.png"))
    above, below = lit(project, "above"), lit(project, "below")
    assert above[BACK].mean() > below[BACK].mean() + 20
    assert above[BELLY].mean() < below[BELLY].mean() - 20


@pytest.mark.slow  # starts Godot
def test_a_map_for_godot_3_is_imported_as_a_normal_map(tmp_path: Path) -> None:
    program(GODOT3, "godot3-server")
    folder = tmp_path / "game"
    folder.mkdir()
    (folder / "project.godot").write_text(PROJECT, encoding="utf-8")
    assert main(["generate", str(FOX), "-o", str(folder), "--engine", "godot3"]) == 0
    asked = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    said = imported(folder)
    assert list((folder / ".import").glob("fox_n.png-*.stex")), said
    written = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    settings = [line for line in asked.splitlines() if line.startswith(("compress", "flags", "detect"))]
    assert len(settings) == 5
    assert not set(settings) - set(written.splitlines())


@pytest.mark.slow  # starts Godot
def test_without_normalgan_one_sentence_says_what_to_do(project: Path) -> None:
    said = imported(project, NORMALGAN="/nowhere/normalgan")
    assert "normalgan was not found; install it and run integrations/install.py again" in said
    assert not list((project / ".import").glob("*.scn"))


@pytest.mark.slow  # starts Godot
def test_what_the_command_says_is_shown(project: Path) -> None:
    (project / "fox.png").write_bytes(b"no picture")
    assert "normalgan: " in (said := imported(project))
    assert "is not an image that can be read" in said


@pytest.fixture
def project_4(tmp_path: Path) -> Path:
    """A project of Godot 4 with the add-on and a drawing that is to be imported by it."""
    godot_4()
    folder = tmp_path / "game"
    folder.mkdir()
    script = own_command(tmp_path)
    install("godot4", tmp_path, "--to", str(folder), "--normalgan", str(script))
    (folder / "project.godot").write_text(PROJECT_4, encoding="utf-8")
    (folder / "fox.png").write_bytes(FOX.read_bytes())
    (folder / "fox.png.import").write_text(IMPORT_4, encoding="utf-8")
    (folder / "lit.gd").write_text(LIT_4, encoding="utf-8")
    return folder


def godot_4() -> str:
    """Return the program of Godot 4, whose name may be that of others too, or skip."""
    for name in ("godot4", "godot"):
        found = shutil.which(name)
        if found and subprocess.check_output([found, "--version"], text=True).startswith("4."):
            return found
    pytest.skip(GODOT4.reason("there is no godot4, and no godot of version 4"))


def imported_4(project: Path, **environment: str) -> str:
    """Import what is new in the project without a window, and return what was said."""
    done = start([godot_4(), "--headless", "--path", str(project), "--import"], project.parent, environment)
    return done.stdout + done.stderr


def lit_4(project: Path, where: str) -> NDArray[np.float64]:
    """Return the scene with its light above or below, as grey."""
    player = [godot_4(), "--audio-driver", "Dummy", "--path", str(project), "-s", "lit.gd", "--", where]
    done = start(player, project.parent, {"LIBGL_ALWAYS_SOFTWARE": "1"}, screen=True)
    with Image.open(project / "shot.png") as image:
        assert image.size == (320, 320), done.stdout + done.stderr
        return np.asarray(image.convert("L"), dtype=np.float64)


@pytest.mark.slow  # starts Godot three times
def test_a_drawing_imported_by_godot_4_is_lit_from_where_the_light_is(project_4: Path) -> None:
    program(GODOT4, "xvfb-run")
    said = imported_4(project_4)
    assert list((project_4 / ".godot" / "imported").glob("fox.png-*.res")), said
    assert not list((project_4 / ".godot" / "imported").glob("*.normal.png"))
    above, below = lit_4(project_4, "above"), lit_4(project_4, "below")
    assert above[BACK].mean() > below[BACK].mean() + 20
    assert above[BELLY].mean() < below[BELLY].mean() - 20


@pytest.mark.slow  # starts Godot
def test_a_map_for_godot_4_is_imported_as_a_normal_map(tmp_path: Path) -> None:
    godot_4()
    folder = tmp_path / "game"
    folder.mkdir()
    (folder / "project.godot").write_text(
        PROJECT_4.replace("PackedStringArray(", "PackedStringArray() #"), "utf-8"
    )
    assert main(["generate", str(FOX), "-o", str(folder), "--engine", "godot"]) == 0
    asked = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    said = imported_4(folder)
    assert list((folder / ".godot" / "imported").glob("fox_n.png-*.ctex")), said
    written = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    settings = [
        line for line in asked.splitlines() if line.startswith(("compress", "roughness", "process", "detect"))
    ]
    assert len(settings) == 5
    assert not set(settings) - set(written.splitlines())


@pytest.mark.slow  # starts Godot
def test_godot_4_says_what_to_do_without_normalgan(project_4: Path) -> None:
    said = imported_4(project_4, NORMALGAN="/nowhere/normalgan")
    assert "normalgan was not found; install it and run integrations/install.py again" in said
    assert not list((project_4 / ".godot" / "imported").glob("*.res"))


@pytest.mark.slow  # starts Godot
def test_godot_4_shows_what_the_command_says(project_4: Path) -> None:
    (project_4 / "fox.png").write_bytes(b"no picture")
    assert "normalgan: " in (said := imported_4(project_4))
    assert "is not an image that can be read" in said


@pytest.mark.parametrize("script", ["plugin.gd", "importer.gd"])
def test_the_importer_for_godot_4_is_in_its_grammar(script: str) -> None:
    parser = pytest.importorskip("gdtoolkit.parser").parser
    path = ROOT / "integrations" / "godot4" / "addons" / "normalgan" / script
    parser.parse(path.read_text(encoding="utf-8"))
