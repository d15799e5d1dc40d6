"""The importers of Godot, each in its Godot; that of Godot 4 by its grammar too, as many machines lack it."""

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from add_ons import FOX, ROOT, install, own_command, program, start
from numpy.typing import NDArray
from PIL import Image

from needs import GODOT3, GODOT4, Need
from normalgan.__main__ import main

PROJECT_3 = """config_version=4

[application]
config/name="lit"

[display]
window/size/width=320
window/size/height=320

[editor_plugins]
enabled=PoolStringArray( "normalgan" )
"""
IMPORT_3 = """[remap]
importer="normalgan"
type="PackedScene"
[deps]
source_file="res://fox.png"
[params]
strength=1.0
cut_out=true
"""
LIT_3 = """extends SceneTree
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
IMPORT_4 = IMPORT_3.replace("PackedScene", "CanvasTexture")
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


@dataclass(frozen=True)
class Godot:
    """What a test has to know of a version of Godot.

    Attributes:
        need: what is said where it is missing.
        names: its programs: the first that is there and of this version edits.
        begins: what it says its version is, as far as that is fixed.
        engine: the name of its import settings (``normalgan generate --engine``).
        add_on: the name of its add-on.
        project: a project file with the add-on.
        plain: the same without the add-on.
        asked: the import settings of a drawing.
        script: a scene under one light, which leaves a picture.
        imported: the folder of what was imported.
        scene: the imported drawing there.
        texture: the imported normal map there.
        importing: the words that import what is new in a project.
        player: the name of the program that shows a scene, if not that which edits.
        playing: the words that show a scene, before that of the light's place.
        settings: how the lines of a normal map's import settings begin.
    """

    need: Need
    names: tuple[str, ...]
    begins: str
    engine: str
    add_on: str
    project: str
    plain: str
    asked: str
    script: str
    imported: str
    scene: str
    texture: str
    importing: tuple[str, ...]
    player: str | None
    playing: tuple[str, ...]
    settings: tuple[str, ...]

    def program(self) -> str:
        """Return the program that edits, whose name may be that of another version too, or skip."""
        for name in self.names:
            if found := shutil.which(name):
                said = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
                if said.stdout.startswith(self.begins):
                    return found
        pytest.skip(self.need.reason(f"there is no {' and no '.join(self.names)} of version {self.begins}x"))

    def open(self, project: Path, **environment: str) -> str:
        """Import what is new in a project, without a window, and return what was said."""
        done = start([self.program(), "--path", str(project), *self.importing], project.parent, environment)
        return done.stdout + done.stderr

    def lit(self, project: Path, where: str) -> NDArray[np.float64]:
        """Return the scene with its light above or below, as grey."""
        player = self.program() if self.player is None else program(self.need, self.player)
        command = [player, "--audio-driver", "Dummy", "--path", str(project), *self.playing, where]
        done = start(command, project.parent, {"LIBGL_ALWAYS_SOFTWARE": "1"}, screen=True)
        with Image.open(project / "shot.png") as image:
            assert image.size == (320, 320), done.stdout + done.stderr
            return np.asarray(image.convert("L"), dtype=np.float64)

    def found(self, project: Path, pattern: str) -> list[Path]:
        """Return what was imported under such names."""
        return list((project / self.imported).glob(pattern))


GODOT_3 = Godot(
    need=GODOT3,
    names=("godot3-server",),
    begins="3.",
    engine="godot3",
    add_on="godot3",
    project=PROJECT_3,
    plain=PROJECT_3,  # its add-on is registered when it is installed
    asked=IMPORT_3,
    script=LIT_3,
    imported=".import",
    scene="fox.png-*.scn",
    texture="fox_n.png-*.stex",
    importing=("--editor", "--quit"),
    player="godot3",
    playing=("--video-driver", "GLES2", "-s", "lit.gd"),
    settings=("compress", "flags", "detect"),
)
GODOT_4 = Godot(
    need=GODOT4,
    names=("godot4", "godot"),
    begins="4.",
    engine="godot",
    add_on="godot4",
    project=PROJECT_4,
    plain=PROJECT_4.replace('"res://addons/normalgan/plugin.cfg"', ""),
    asked=IMPORT_4,
    script=LIT_4,
    imported=".godot/imported",
    scene="fox.png-*.res",
    texture="fox_n.png-*.ctex",
    importing=("--headless", "--import"),
    player=None,
    playing=("-s", "lit.gd", "--"),
    settings=("compress", "roughness", "process", "detect"),
)


@pytest.fixture(params=[GODOT_3, GODOT_4], ids=["3", "4"])
def godot(request: pytest.FixtureRequest) -> Godot:
    """Each Godot that is installed."""
    given: Godot = request.param
    given.program()
    return given


@pytest.fixture
def project(godot: Godot, tmp_path: Path) -> Path:
    """A project with the add-on and a drawing that is to be imported by it."""
    folder = tmp_path / "game"
    folder.mkdir()
    script = own_command(tmp_path)
    install(godot.add_on, tmp_path, "--to", str(folder), "--normalgan", str(script))
    (folder / "project.godot").write_text(godot.project, encoding="utf-8")
    (folder / "fox.png").write_bytes(FOX.read_bytes())
    (folder / "fox.png.import").write_text(godot.asked, encoding="utf-8")
    (folder / "lit.gd").write_text(godot.script, encoding="utf-8")
    return folder


@pytest.mark.slow  # starts Godot three times
def test_an_imported_drawing_is_lit_from_where_the_light_is(godot: Godot, project: Path) -> None:
    program(godot.need, "xvfb-run")
    said = godot.open(project)
    assert godot.found(project, godot.scene), said
    assert not godot.found(project, "*.normal.png")
    above, below = godot.lit(project, "above"), godot.lit(project, "below")
    assert above[BACK].mean() > below[BACK].mean() + 20
    assert above[BELLY].mean() < below[BELLY].mean() - 20


@pytest.mark.slow  # starts Godot
def test_a_map_for_godot_is_imported_as_a_normal_map(godot: Godot, tmp_path: Path) -> None:
    folder = tmp_path / "game"
    folder.mkdir()
    (folder / "project.godot").write_text(godot.plain, encoding="utf-8")
    assert main(["generate", str(FOX), "-o", str(folder), "--engine", godot.engine]) == 0
    asked = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    said = godot.open(folder)
    assert godot.found(folder, godot.texture), said
    written = (folder / "fox_n.png.import").read_text(encoding="utf-8")
    settings = [line for line in asked.splitlines() if line.startswith(godot.settings)]
    assert len(settings) == 5
    assert not set(settings) - set(written.splitlines())


@pytest.mark.slow  # starts Godot
def test_without_normalgan_one_sentence_says_what_to_do(godot: Godot, project: Path) -> None:
    said = godot.open(project, NORMALGAN="/nowhere/normalgan")
    assert "normalgan was not found; install it and run integrations/install.py again" in said
    assert not godot.found(project, godot.scene)


@pytest.mark.slow  # starts Godot
def test_what_the_command_says_is_shown(godot: Godot, project: Path) -> None:
    (project / "fox.png").write_bytes(b"no picture")
    assert "normalgan: " in (said := godot.open(project))
    assert "is not an image that can be read" in said


@pytest.mark.parametrize("script", ["plugin.gd", "importer.gd"])
def test_the_importer_for_godot_4_is_in_its_grammar(script: str) -> None:
    parser = pytest.importorskip("gdtoolkit.parser").parser
    path = ROOT / "integrations" / "godot4" / "addons" / "normalgan" / script
    parser.parse(path.read_text(encoding="utf-8"))
