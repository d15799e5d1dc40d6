"""Outputs beside the map: shading maps, heights of one scale, conventions of engines, simpler reliefs."""

import ast
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from PIL import Image

from normal_pngs import read_png
from normalgan.__main__ import main
from normalgan.arrays import Floats
from normalgan.inference.heights.height import integrate
from normalgan.inference.heights.relief_mesh import relief_mesh, simpler
from normalgan.inference.outputs.occlusion import occlusion
from normalgan.inference.outputs.shading import curvature
from normalgan.normals import normalize
from pens import blob, outline

SIDE = 128


@pytest.fixture
def here(here: Path) -> Path:
    """Two drawings beside the model: a large one and a small one."""
    for name, radius in (("fox", 60), ("cub", 20)):
        drawing = 255 * (1 - outline(blob(radius=radius)))
        Image.fromarray(np.rint(drawing).astype(np.uint8)).save(f"{name}.png")
    return here


def generate(*arguments: str) -> int:
    return main(["generate", "--model", "model.onnx", *arguments])


def read(path: str) -> NDArray[np.generic]:
    found = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    assert found is not None
    return found


def surface(z: NDArray[np.floating]) -> tuple[Floats, Floats]:
    """Return the normals and the height (H, W) of a surface."""
    down, right = np.gradient(z.astype(np.float64))
    return normalize(np.dstack([-right, down, np.ones_like(z)])), z.astype(np.float32)


def grid() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    along = np.arange(SIDE) - SIDE / 2 + 0.5
    return np.meshgrid(along, along)


def test_hollows_are_dark_and_ridges_light() -> None:
    x, y = grid()
    everywhere = np.ones((SIDE, SIDE), bool)
    groove = -12 * np.exp(-(x**2) / 18)
    normals, height = surface(groove)
    dark = occlusion(height, normals, everywhere)
    assert dark[64, 64] < 0.75
    assert dark[64, 20] > 0.97
    bends = curvature(normals, everywhere)
    assert bends[64, 64] < 0.1
    assert abs(bends[64, 10] - 0.5) < 0.02
    assert curvature(surface(-groove)[0], everywhere)[64, 64] > 0.9
    plane, height = surface(0.7 * x + 0.2 * y)
    assert occlusion(height, plane, everywhere)[30:90, 30:90].min() > 0.99
    assert np.abs(curvature(plane, everywhere) - 0.5).max() < 0.01


@pytest.mark.slow
def test_a_large_map_is_as_dark_as_a_small_one() -> None:
    x, _ = grid()
    groove = np.kron(-12 * np.exp(-(x**2) / 18), np.ones((12, 12))) * 12
    normals, height = surface(np.asarray(cv2.GaussianBlur(groove, (0, 0), 8), np.float64))
    large = occlusion(height, normals, np.ones(height.shape, bool))
    assert large.shape == (1536, 1536)
    assert large[768, 768] < 0.8
    assert large[768, 200] > 0.97


def test_all_shading_maps_are_written(here: Path) -> None:
    assert generate("fox.png", "--ao", "--curvature", "--specular", "-o", ".") == 0
    for name, off in (("ao", 255), ("curvature", 128), ("specular", 0)):
        values = read(f"fox_{name}.png")
        assert values.shape == (200, 300)
        assert values.dtype == np.uint8
        assert values[5, 5] == off
    before = sorted(here.iterdir())
    assert generate("*.png", "--ao", "--curvature", "--specular", "-o", ".") == 0
    fresh = {path.name for path in set(here.iterdir()) - set(before)}
    assert fresh == {"cub_normal.png", "cub_ao.png", "cub_curvature.png", "cub_specular.png"}


def test_strength_multiplies_slopes(here: Path) -> None:
    assert generate("fox.png", "-o", "one", "--bits", "16") == 0
    assert generate("fox.png", "-o", "two", "--bits", "16", "--strength", "2") == 0
    one, two = (read_png(f"{name}/fox_normal.png")[0][70:120, 140:200] for name in ("one", "two"))
    slopes = [each[..., :2] / each[..., 2:] for each in (one, two)]
    assert np.abs(2 * slopes[0] - slopes[1]).max() < 1e-3
    assert generate("fox.png", "-o", "none", "--strength", "0") == 0
    assert (read("none/fox_normal.png") == (255, 128, 128)).all()


def test_heights_of_a_batch_have_one_scale(here: Path) -> None:
    tops = {}
    for scale in ("own", "batch", "80"):
        asked = [] if scale == "own" else ["--height-scale", scale]
        assert generate("fox.png", "cub.png", "--height", "png", "-o", scale, *asked) == 0
        tops[scale] = {name: int(read(f"{scale}/{name}_height.png").max()) for name in ("fox", "cub")}
    assert generate("fox.png", "cub.png", "--height", "tiff", "-o", "exact") == 0
    spans = {name: float(np.ptp(read(f"exact/{name}_height.tiff").astype(float))) for name in ("fox", "cub")}
    assert tops["own"] == {"fox": 65535, "cub": 65535}
    assert tops["batch"]["fox"] == 65535
    for scale, white in (("batch", spans["fox"]), ("80", 80)):
        for name in ("fox", "cub"):
            assert tops[scale][name] == pytest.approx(65535 * spans[name] / white, rel=1e-3), (scale, name)


def test_the_frames_of_a_moving_drawing_have_the_scale_of_the_batch_once(here: Path) -> None:
    """Frames are of one scale in any case; with that of a batch they are not brought to it twice."""
    frames = [Image.open(f"{name}.png").copy() for name in ("fox", "cub")]
    frames[0].save("both.gif", save_all=True, append_images=frames[1:], duration=100)
    for scale in ([], ["--height-scale", "batch"]):
        assert generate("both.gif", "fox.png", "--height", "png", "-o", f"levels{len(scale)}", *scale) == 0
    assert generate("both.gif", "--height", "tiff", "-o", "exact") == 0
    spans = [float(np.ptp(read(f"exact/both_000{i}_height.tiff").astype(float))) for i in (1, 2)]
    for folder in ("levels0", "levels2"):
        tops = [int(read(f"{folder}/both_000{i}_height.png").max()) for i in (1, 2)]
        assert tops[1] / tops[0] == pytest.approx(spans[1] / spans[0], rel=1e-2), folder


@pytest.mark.parametrize("engine", ["unity", "unreal", "godot", "godot3", "blender"])
def test_an_engine_sets_its_conventions_and_is_told_how_to_import(here: Path, engine: str) -> None:
    assert generate("fox.png", "-o", "plain", "--pad", "16") == 0
    assert generate("fox.png", "-o", "out", "--engine", engine) == 0
    names = {path.name for path in Path("out").iterdir()}
    map_name, sidecar, green, kind = {
        "unity": ("fox_NormalMap.png", ".meta", 1, np.uint8),
        "unreal": ("fox_N.png", ".import.py", -1, np.uint8),
        "godot": ("fox_n.png", ".import", 1, np.uint8),
        "godot3": ("fox_n.png", ".import", -1, np.uint8),
        "blender": ("fox_normal.png", ".import.py", 1, np.uint16),
    }[engine]
    assert names == {map_name, map_name + sidecar}
    assert read(f"out/{map_name}").dtype == kind
    upright = read_png("plain/fox_normal.png")[0]
    assert np.abs(read_png(f"out/{map_name}")[0] - upright * (1, green, 1)).max() < 0.02
    text = Path(f"out/{map_name}{sidecar}").read_text()
    match engine:
        case "unity":
            assert yaml.safe_load(text)["TextureImporter"]["textureType"] == 1
        case "godot" | "godot3":
            assert "compress/normal_map=1" in text
        case _:
            ast.parse(text)
            assert map_name in text
    # What the engine has made of its own file stays; a script is ours.
    Path(f"out/{map_name}{sidecar}").write_text("the engine's")
    assert generate("fox.png", "-o", "out", "--engine", engine) == 0
    kept = Path(f"out/{map_name}{sidecar}").read_text()
    assert kept == (text if sidecar.endswith(".py") else "the engine's")
    # What the user says counts more.
    assert generate("fox.png", "-o", "own", "--engine", engine, "--y", "up", "--suffix", "_own") == 0
    assert np.abs(read_png("own/fox_own.png")[0] - upright).max() < 0.02


def test_maps_of_one_name_in_two_folders_have_two_ids(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ids = set()
    for folder in ("a", "b"):
        Path(folder).mkdir()
        with monkeypatch.context() as patch:
            patch.chdir(folder)
            assert generate("../fox.png", "--engine", "unity", "--model", str(here / "model.onnx")) == 0
            ids.add(yaml.safe_load(Path("normals/fox_NormalMap.png.meta").read_text())["guid"])
    assert len(ids) == 2


def test_a_relief_of_fewer_faces_is_closed_and_of_the_same_shape(here: Path) -> None:
    import trimesh

    for faces in (None, 5000, 500):
        asked = [] if faces is None else ["--faces", str(faces)]
        assert generate("fox.png", "--relief", "glb", "-o", str(faces), *asked) == 0
    whole, some, few = (trimesh.load_mesh(f"{faces}/fox_relief.glb") for faces in (None, 5000, 500))
    assert len(whole.faces) > 20_000
    assert 3000 < len(some.faces) <= 5000
    assert 200 < len(few.faces) <= 500
    for mesh in (some, few):
        assert mesh.is_volume
    assert some.volume == pytest.approx(whole.volume, rel=0.1)
    thin = np.zeros((60, 60), bool)
    thin[30] = True
    assert len(relief_mesh(*simpler(np.zeros((60, 60), np.float32), thin, 12)).faces) > 0


def test_the_height_of_a_large_map_is_that_of_a_reduced_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("normalgan.inference.heights.height._MOST", 384)  # in place of 1536
    along = (np.arange(400) + 0.5) / 200 - 1  # more than are solved for
    x, y = np.meshgrid(along, -along)
    inside = 1 - (x / 0.8) ** 2 - (y / 0.6) ** 2
    z = 0.5 * np.sqrt(np.maximum(inside, 0))
    mask = inside > 0
    found = integrate(normalize(np.dstack([x / 0.64, y / 0.36, z / 0.25])), mask)
    slope = np.polyfit(200 * z[mask], found[mask], 1)[0]
    assert slope == pytest.approx(1, abs=0.03)
    assert np.corrcoef(found[mask], z[mask])[0, 1] > 0.998


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--height-scale", "5"], "--height-scale is a setting of the height map; add --height png"),
        (
            ["--height", "tiff", "--height-scale", "5"],
            "a height scale applies to PNG; a height map as tiff holds pixels.",
        ),
        (["--faces", "500"], "--faces is a setting of the relief mesh; add --relief glb, or leave it out."),
        (["--relief", "obj", "--faces", "2"], "--faces is 2; it must be 12 or more."),
        (["--engine", "unity3d"], "expected"),
    ],
)
def test_what_cannot_be_used_is_told(
    here: Path, arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert generate("fox.png", *arguments) == 2
    said = capsys.readouterr().err
    assert sentence.lower() in said.lower()
    assert len(said.splitlines()) == 1
