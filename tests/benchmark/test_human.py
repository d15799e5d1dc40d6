"""Drawings by people: small made-up files in the layouts of three data sets, with a mesh and its camera."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from normalgan.__main__ import main
from normalgan.arrays import Doubles
from normalgan.benchmark.human.command import find_drawings, tables
from normalgan.benchmark.human.evaluation import measure_drawings, sample_of
from normalgan.benchmark.human.registration import PlacedMesh, camera_of, fit_projection, read_placed_mesh
from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.predictor import Predictor

SIDE = 64
CENTRE, RADIUS = np.array([3.0, -2.0, 5.0]), 2.0
"""Of a ball that lies anywhere in its file."""


def perspective(side: float = SIDE, distance: float = 12.0) -> Doubles:
    """A camera that sees the ball from the front and above, off the middle of the sheet; y is downwards."""
    tilt = np.deg2rad(30)
    turned = np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]])
    rotation = np.diag([1.0, -1.0, -1.0]) @ turned
    shift = np.array([0.0, 0.0, distance]) - rotation @ CENTRE
    calibration = np.array([[1.5 * side, 0, 0.45 * side], [0, 1.5 * side, 0.55 * side], [0, 0, 1]])
    return np.asarray(calibration @ np.c_[rotation, shift])


def orthographic(side: float = SIDE) -> Doubles:
    """A camera that sees the ball from +z, its middle in that of the sheet, a third of it in radius."""
    scale = side / 3 / RADIUS
    rows = np.array([[scale, 0, 0, 0], [0, -scale, 0, 0], [0, 0, 0, 1.0]])
    rows[:2, 3] = side / 2 - rows[:2, :3] @ CENTRE
    return rows


def project(matrix: Doubles, points: Doubles) -> Doubles:
    seen = np.c_[points, np.ones(len(points))] @ matrix.T
    return np.asarray(seen[:, :2] / seen[:, 2:])


def write_ball(path: Path) -> Path:
    ball = trimesh.creation.icosphere(4, RADIUS)
    ball.apply_translation(CENTRE)
    path.parent.mkdir(parents=True, exist_ok=True)
    ball.export(path)
    return path


def outline(matrix: Doubles, side: int) -> list[list[float]]:
    """The edge of the projected ball: of all points on it, the farthest in each direction."""
    pixels = project(matrix, np.asarray(trimesh.creation.icosphere(4, RADIUS).vertices) + CENTRE)
    middle = pixels.mean(axis=0)
    around = np.linspace(0, 2 * np.pi, 60)
    ways = np.stack([np.cos(around), np.sin(around)], axis=-1)
    reach = ((pixels - middle) @ ways.T).max(axis=0)
    assert (middle + reach.max() < side).all()
    assert (middle - reach.max() > 0).all()
    return (middle + reach[:, None] * ways).round(3).tolist()  # type: ignore[no-any-return]


def write_opensketch(folder: Path) -> None:
    matrix = perspective()
    write_ball(folder / "objects" / "ball.obj")
    points = CENTRE + RADIUS * np.array(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0.6, 0.8, 0], [0, 0.6, 0.8], [0.5, -0.5, 0.7]]
    )
    pairs = {"points_2D_sketch": project(matrix, points).tolist(), "points_3D_object": points.tolist()}
    (folder / "points").mkdir()
    (folder / "points" / "professional1_ball_v1_points.json").write_text(json.dumps(pairs))
    drawn = [{"x": x, "y": y, "p": 0.5, "t": i} for i, (x, y) in enumerate(outline(matrix, SIDE))]
    gone = [{"x": 0, "y": 0, "p": 1, "t": 0}, {"x": 60, "y": 60, "p": 1, "t": 1}]
    strokes = [{"is_removed": False, "points": drawn}, {"is_removed": True, "points": gone}]
    sketch = {"canvas": {"height": SIDE, "width": SIDE, "pen_width": 3.0}, "strokes": strokes}
    for view, thing in ((1, "ball"), (2, "ball"), (1, "vase")):  # of two there is no mesh or no points
        path = folder / "sketches" / "Professional1" / thing / f"view{view}_concept.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(sketch))


def write_cameras(folder: Path, view: str, matrix: Doubles) -> None:
    write_ball(folder / "meshes" / "ball.ply")
    content = {view: {"mesh": "meshes/ball.ply", "projection": matrix.tolist()}}
    (folder / "cameras.json").write_text(json.dumps(content))


def write_differsketching(folder: Path) -> None:
    matrix = orthographic(800)
    write_cameras(folder, "8_1_ball", matrix)
    line = {"path": outline(matrix, 800), "draw_type": 0, "width": 4}
    rubber = {"path": [[0, 0], [799, 799]], "draw_type": 1, "width": 4}
    for name in ("P021_8_1_ball", "N003_8_1_ball", "N003_8_2_cat"):
        path = folder / "Primitive" / "original_json" / f"{name}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"strokes": [line, rubber]}))


def write_tracings(folder: Path) -> None:
    matrix = orthographic(800)
    write_cameras(folder, "ball.png", matrix)
    path = ",".join(f"{1600000000 + i},{x},{y}" for i, (x, y) in enumerate(outline(matrix, 800)))
    stroke = {"path": path, "pressure": "1", "color": "#000000", "width": 2, "opacity": 0.5}
    (folder / "tracings.json").write_text(
        json.dumps({"ball.png": {"p7": [stroke]}, "boat.png": {"p7": [stroke]}})
    )
    (folder / "drawings.json").write_text(json.dumps({"ball.png": {"p8": [stroke]}}))


@pytest.mark.parametrize("matrix", [perspective(), -3 * perspective(), orthographic(), 0.5 * orthographic()])
def test_a_camera_shows_the_mesh_where_its_projection_does(tmp_path: Path, matrix: Doubles) -> None:
    placed = read_placed_mesh(write_ball(tmp_path / "ball.ply"))
    camera = camera_of(matrix, placed, SIDE)
    whole = np.c_[placed.mesh.vertices, np.ones(len(placed.mesh.vertices))]
    clip = whole @ (camera.projection_matrix() @ camera.view_matrix()).T
    assert (np.abs(clip[:, 2]) < clip[:, 3]).all()
    found = (clip[:, :2] / clip[:, 3:] * [0.5, -0.5] + 0.5) * SIDE
    in_file = (whole @ placed.to_file.T)[:, :3]
    np.testing.assert_allclose(found, project(matrix, in_file), atol=1e-3)
    np.testing.assert_allclose(camera.rotation @ camera.rotation.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(camera.rotation) == pytest.approx(1)


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_the_unit_of_a_mesh_does_not_matter(tmp_path: Path, scale: float) -> None:
    ball = trimesh.creation.icosphere(2, RADIUS)
    lines = ["OFF", f"{len(ball.vertices)} {len(ball.faces)} 0"]
    lines += [" ".join(map(repr, row)) for row in ((ball.vertices + CENTRE) * scale).tolist()]
    lines += ["3 " + " ".join(map(str, row)) for row in ball.faces.tolist()]
    (tmp_path / "ball.off").write_text("\n".join(lines))
    placed = read_placed_mesh(tmp_path / "ball.off")
    np.testing.assert_allclose(np.linalg.norm(placed.mesh.vertices, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(placed.to_file[:3, 3] / scale, CENTRE)
    np.testing.assert_allclose(placed.to_file[:3, :3] / scale, RADIUS * np.eye(3), atol=1e-9)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.diag([-1.0, 1.0, 1.0]) @ perspective(), "mirror"),
        (np.array([[1, 0.2, 0], [0, 1, 0], [0, 0, 1.0]]) @ perspective(), "skewed"),
        (np.diag([2.0, 1.0, 1.0]) @ orthographic(), "stretched"),
        (perspective(distance=1.0), "stands within the mesh"),
        (np.zeros((3, 4)), "no matrix of finite numbers"),
    ],
)
def test_what_is_no_camera_is_refused(tmp_path: Path, matrix: Doubles, message: str) -> None:
    placed: PlacedMesh = read_placed_mesh(write_ball(tmp_path / "ball.ply"))
    with pytest.raises(InputError, match=message):
        camera_of(matrix, placed, SIDE)


def test_a_camera_is_fitted_to_points_and_says_how_far_it_is_off() -> None:
    rng = np.random.default_rng(0)
    points = CENTRE + RADIUS * rng.uniform(-1, 1, (12, 3))
    pixels = project(perspective(), points)
    found, misses = fit_projection(points, pixels)
    assert misses < 1e-3
    np.testing.assert_allclose(project(found, points + 0.1), project(perspective(), points + 0.1), atol=0.01)
    _, misses = fit_projection(points, pixels + rng.normal(0, 2, pixels.shape))
    assert 0.5 < misses < 3
    with pytest.raises(InputError, match="in one plane"):
        fit_projection(points * [1, 1, 0], pixels)
    with pytest.raises(InputError, match="6 pairs of points or more, not to 5"):
        fit_projection(points[:5], pixels[:5])


def truth(picture: Any, hints: Any) -> NormalMap:
    """A predictor that knows the ball of `orthographic`, by its formula."""
    side = picture.shape[0]
    steps = (np.arange(side) + 0.5 - side / 2) / (side / 3)
    x, y = np.meshgrid(steps, -steps)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))
    normal = np.stack([x, y, z], axis=-1).astype(np.float32)
    normal[~inside] = [0, 0, 1]
    return NormalMap(normal, inside, inside.astype(np.float32), picture, None, "")


@pytest.mark.parametrize("write", [write_differsketching, write_tracings])
def test_the_truth_painted_by_its_formula_has_no_error(tmp_path: Path, write: Any) -> None:
    write(tmp_path)
    found = find_drawings(tmp_path)
    names = [drawing.name for drawing in found.drawings]
    if write is write_differsketching:
        assert sorted(names) == ["ball/original_N003_8_1_ball", "ball/original_P021_8_1_ball"]
        assert {drawing.group for drawing in found.drawings} == {"novices original", "professionals original"}
        assert found.left_out[0].endswith("is left out: cameras.json has no view 8_2_cat.")
    else:
        assert names == ["ball/ball_p7_traced", "ball/ball_p8_freehand"]
        assert "of 1 of 2 prompts cameras.json has no view, such as boat.png" in found.left_out[0]
        assert "boat.png" in found.left_out[0]
    predictor: Predictor = truth  # type: ignore[assignment]
    measured = measure_drawings(found.drawings[:1], predictor, 0, 1, print)
    (one,) = measured.drawings
    assert one["figures"]["0"]["angular_mean"] < 0.5
    assert one["figures"]["0"]["mask_iou"] > 0.99
    (group,) = measured.groups.values()
    assert group["figures"]["0"]["angular_mean"] == pytest.approx(
        one["figures"]["0"]["angular_mean"], abs=1e-3
    )
    assert "| ball/" in tables(found.layout, "truth", measured)
    (batch,) = [sample_of(found.drawings[0])]
    rows, columns = np.nonzero(batch["sketch"][0, 0].numpy() > 0.1)
    inside_rows, inside_columns = np.nonzero(batch["mask"][0, 0].numpy())
    for drawn, there in ((rows, inside_rows), (columns, inside_columns)):  # the ball lies within its outline
        assert abs(drawn.min() - there.min()) <= 3
        assert abs(drawn.max() - there.max()) <= 3


def test_opensketch_from_a_folder_to_a_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, out = tmp_path / "data", tmp_path / "out"
    folder.mkdir()
    write_opensketch(folder)
    assert main(["benchmark", "--human", str(folder), "-o", str(out), "--rows", "concept"]) == 0
    said = capsys.readouterr().out
    assert "OpenSketch: 1 drawings" in said
    results = json.loads((out / "results.json").read_text(encoding="utf-8"))
    (one,) = results["drawings"]
    assert one["name"] == "ball/Professional1_view1_concept"
    assert one["camera_misses"] < 0.01
    assert one["figures"]["0"]["mask_iou"] > 0.8  # the removed stroke across the sheet is not drawn
    assert one["figures"]["0"]["angular_mean"] < 40
    assert one["figures"]["15"]["angular_mean"] < one["figures"]["0"]["angular_mean"]
    assert results["groups"]["concept"]["figures"]["0"]["calibration_error"] > 0
    assert len(results["left_out"]) == 2
    assert any("there is no vase.obj anywhere" in sentence for sentence in results["left_out"])
    assert any(
        "there is no professional1_ball_v2_points.json" in sentence for sentence in results["left_out"]
    )
    assert str(tmp_path) not in json.dumps({**results, "left_out": []})
    assert {path.name for path in out.iterdir()} == {"results.json", "table.md", "gallery.png"}
    assert "ball/Professional1_view1_concept | concept |" in (out / "table.md").read_text(encoding="utf-8")


def edited(path: Path, change: Callable[[Any], Any]) -> None:
    content = json.loads(path.read_text())
    path.write_text(json.dumps(change(content)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda sketch: {**sketch, "strokes": [None, *sketch["strokes"]]}, "not laid out like OpenSketch"),
        (lambda sketch: {**sketch, "strokes": {"a": 1}}, "not laid out like OpenSketch"),
        (lambda sketch: {**sketch, "canvas": {**sketch["canvas"], "pen_width": -3}}, "-3 wide and 0.5 dark"),
        (lambda sketch: {**sketch, "canvas": {**sketch["canvas"], "pen_width": 1e9}}, r"5e\+08 wide"),
    ],
    ids=["a stroke that is null", "strokes by name", "a negative pen", "a pen that takes all memory"],
)
def test_a_damaged_sketch_of_opensketch_is_left_out_alone(
    tmp_path: Path, change: Callable[[Any], Any], message: str
) -> None:
    write_opensketch(tmp_path)
    place = tmp_path / "sketches" / "Professional1" / "ball"
    (place / "view1_presentation.json").write_bytes((place / "view1_concept.json").read_bytes())
    edited(place / "view1_concept.json", change)
    found = find_drawings(tmp_path)
    assert [one.group for one in found.drawings] == ["presentation"]
    assert re.search(message, found.left_out[0])


def test_opensketch_is_read_from_within_the_folder_of_an_object(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_opensketch(tmp_path)
    monkeypatch.chdir(tmp_path / "sketches" / "Professional1" / "ball")
    with pytest.raises(InputError, match=r"there is no ball\.obj anywhere in the folder"):
        find_drawings(Path())


def test_points_that_are_no_pairs_are_counted() -> None:
    points = np.random.default_rng(0).normal(size=(9, 3))
    with pytest.raises(InputError, match=r"^9 points of it are given, and 8 places where they are drawn\.$"):
        fit_projection(points, points[:8, :2])


@pytest.mark.parametrize("drawings", [[1], None, "p8"])
def test_a_prompt_without_drawings_by_participant_is_left_out_alone(tmp_path: Path, drawings: Any) -> None:
    write_tracings(tmp_path)
    edited(tmp_path / "drawings.json", lambda content: {"ball.png": drawings})
    found = find_drawings(tmp_path)
    assert [one.group for one in found.drawings] == ["traced"]
    assert found.left_out[-1] == "drawings.json: ball.png is left out: it has no drawings by participant."


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"opacity": 0}, r"none of its lines can be seen on the sheet"),
        ({"path": "0,1,1,0,9,9,0,9,1"}, r"lie apart: their boxes share 0%; is the camera for a sheet of 800"),
    ],
    ids=["invisible", "elsewhere"],
)
def test_a_drawing_that_is_not_of_its_object_is_not_measured(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    write_tracings(tmp_path)
    edited(
        tmp_path / "drawings.json",
        lambda content: {"ball.png": {"p8": [{**content["ball.png"]["p8"][0], **change}]}},
    )
    drawn = next(one for one in find_drawings(tmp_path).drawings if one.group == "freehand")
    with pytest.raises(InputError, match=message):
        sample_of(drawn)


@pytest.mark.parametrize(
    ("make", "more", "message"),
    [
        (lambda folder: (folder / "a.json").write_text("{}"), [], "layout of no data set that is known"),
        (lambda folder: (folder / "tracings.json").write_text("{}"), [], "has drawings but no cameras.json"),
        (write_tracings, ["--rows", "trace"], "Did you mean traced"),
        (write_tracings, ["--seeds", "1"], "--human takes no --seeds"),
        (write_opensketch, ["--evaluate", "none.onnx"], "none.onnx"),
    ],
)
def test_what_cannot_be_used_is_said_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], make: Any, more: list[str], message: str
) -> None:
    folder = tmp_path / "data"
    folder.mkdir()
    make(folder)
    assert main(["benchmark", "--human", str(folder), "-o", str(tmp_path / "out"), *more]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()
