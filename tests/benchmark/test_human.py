"""Drawings by people: a made-up drawing of a ball, with its mesh and camera or its normal map."""

import json
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import trimesh

from normalgan import normals
from normalgan.__main__ import main
from normalgan.arrays import Doubles
from normalgan.benchmark.human.command import tables
from normalgan.benchmark.human.drawings import read_drawings
from normalgan.benchmark.human.evaluation import measure_drawings, sample_of
from normalgan.benchmark.human.registration import PlacedMesh, camera_of, read_placed_mesh
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


def draw(path: Path, points: list[list[float]], shape: tuple[int, int] = (SIDE, SIDE)) -> None:
    """Write a closed line on paper."""
    paper = np.full(shape, 255, np.uint8)
    cv2.polylines(paper, [np.rint(points).astype(np.int32)], True, 0, 2)
    assert cv2.imwrite(str(path), paper)


def write_ball_map(path: Path, side: int) -> None:
    """Write the normal map of the ball of `orthographic`."""
    known = truth(np.ones((side, side, 1)), None)
    path.write_bytes(normals.encode_png(np.where(known.mask[..., None], known.normal, 0)))


def write_drawings(folder: Path, **more: Any) -> None:
    """Write a folder of two drawings, one with its mesh and one with its normal map, and further entries."""
    write_ball(folder / "meshes" / "ball.ply")
    flat = orthographic()
    draw(folder / "ball.png", outline(flat, SIDE), (SIDE, SIDE - 4))  # padded to the camera's square
    draw(folder / "round.png", outline(flat, SIDE))
    write_ball_map(folder / "round_normal.png", SIDE)
    mesh = {"drawing": "ball.png", "mesh": "meshes/ball.ply", "projection": flat.tolist(), "group": "concept"}
    drawn = {"ball/anna": mesh, "round/ben": {"drawing": "round.png", "normal": "round_normal.png"}}
    (folder / "drawings.json").write_text(json.dumps(drawn | more))


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


def test_the_projection_of_the_docs_shows_a_mesh_at_the_origin(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "compare.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"^```json\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (matrix,) = (entry["projection"] for entry in json.loads(example).values() if "projection" in entry)
    trimesh.creation.icosphere(1).export(tmp_path / "ball.ply")
    assert camera_of(np.array(matrix, float), read_placed_mesh(tmp_path / "ball.ply"), 64).perspective


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
        (perspective(distance=1.0), "is inside the mesh"),
        (np.zeros((3, 4)), "must hold finite numbers"),
    ],
)
def test_a_projection_without_a_camera_is_refused(tmp_path: Path, matrix: Doubles, message: str) -> None:
    placed: PlacedMesh = read_placed_mesh(write_ball(tmp_path / "ball.ply"))
    with pytest.raises(InputError, match=message):
        camera_of(matrix, placed, SIDE)


def truth(picture: Any, hints: Any) -> NormalMap:
    """A predictor that knows the ball of `orthographic`, by its formula."""
    side = picture.shape[0]
    steps = (np.arange(side) + 0.5 - side / 2) / (side / 3)
    x, y = np.meshgrid(steps, -steps)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))
    normal = np.stack([x, y, z], axis=-1).astype(np.float32)
    normal[~inside] = [0, 0, 1]
    return NormalMap(normal, inside, inside.astype(np.float32), picture, None, ())


def test_the_true_normals_have_no_error(tmp_path: Path) -> None:
    write_drawings(tmp_path)
    drawings, left_out = read_drawings(tmp_path)
    assert [(one.name, one.group) for one in drawings] == [("ball/anna", "concept"), ("round/ben", "all")]
    assert left_out == []
    predictor: Predictor = truth  # type: ignore[assignment]
    measured = measure_drawings(drawings, predictor, 0, 1, print)
    for one in measured.drawings:
        assert one["figures"]["0"]["angular_mean"] < 0.5
        assert one["figures"]["0"]["mask_iou"] > 0.99
        assert one["size"] == SIDE
        group = measured.groups[one["group"]]
        assert group["figures"]["0"]["angular_mean"] == pytest.approx(
            one["figures"]["0"]["angular_mean"], abs=1e-3
        )
    assert [one["object"] for one in measured.drawings] == ["ball", "round"]
    assert "| ball/anna | concept |" in tables("truth", measured)
    for batch in map(sample_of, drawings):
        drawn, there = (np.nonzero(batch[key][0, 0].numpy() > 0.1) for key in ("sketch", "mask"))
        for ink, inside in zip(drawn, there, strict=True):  # the ball lies within its outline
            assert abs(ink.min() - inside.min()) <= 3
            assert abs(ink.max() - inside.max()) <= 3


def test_from_a_folder_to_a_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, out = tmp_path / "data", tmp_path / "out"
    folder.mkdir()
    write_drawings(folder, cat={"drawing": "cat.png", "mesh": "cat.obj"})
    assert main(["benchmark", "--human", str(folder), "-o", str(out), "--rows", "concept"]) == 0
    assert "1 drawings in" in capsys.readouterr().out
    results = json.loads((out / "results.json").read_text(encoding="utf-8"))
    (one,) = results["drawings"]
    assert one["name"] == "ball/anna"
    assert one["figures"]["0"]["mask_iou"] > 0.8
    assert one["figures"]["0"]["angular_mean"] < 40
    assert one["figures"]["15"]["angular_mean"] < one["figures"]["0"]["angular_mean"]
    assert results["groups"]["concept"]["figures"]["0"]["calibration_error"] > 0
    assert "cat in" in results["left_out"][0]
    assert str(tmp_path) not in json.dumps({**results, "left_out": []})
    assert {path.name for path in out.iterdir()} == {"results.json", "table.md", "gallery.png"}


BALL: dict[str, Any] = {
    "drawing": "ball.png",
    "mesh": "meshes/ball.ply",
    "projection": orthographic().tolist(),
}


@pytest.mark.parametrize(
    "entry",
    [
        None,
        "ball.png",
        {},
        {"drawing": "ball.png"},
        {**BALL, "projection": [[1, 2], [3, 4]]},
        {**BALL, "projection": [["a"] * 4] * 3},
        {**BALL, "normal": "round_normal.png"},
        {**BALL, "strokes": []},
        {"drawing": "round.png", "normal": "round_normal.png", "projection": BALL["projection"]},
    ],
)
def test_a_damaged_entry_is_left_out_alone(tmp_path: Path, entry: Any) -> None:
    write_drawings(tmp_path, bad=entry)
    drawings, left_out = read_drawings(tmp_path)
    assert [one.name for one in drawings] == ["ball/anna", "round/ben"]
    (sentence,) = left_out
    assert sentence.startswith("bad in ")
    assert "is left out: its entry must be like" in sentence


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({**BALL, "drawing": "none.png"}, "none.png"),
        ({**BALL, "mesh": "none.ply"}, "none.ply"),
        ({**BALL, "drawing": "paper.png"}, "is all white"),
        ({**BALL, "drawing": "corner.png"}, "boxes overlap by 0%; is the camera for a sheet of 64 pixels"),
        ({**BALL, "projection": (np.diag([10, 10, 1]) @ orthographic()).tolist()}, "does not see the mesh"),
        ({"drawing": "corner.png", "normal": "small_normal.png"}, "pixel on pixel"),
    ],
)
def test_a_drawing_that_cannot_be_compared_is_left_out(
    tmp_path: Path, entry: dict[str, Any], message: str
) -> None:
    write_drawings(tmp_path, bad=entry)
    draw(tmp_path / "paper.png", [])
    draw(tmp_path / "corner.png", [[0, 0], [4, 0], [4, 4]])
    write_ball_map(tmp_path / "small_normal.png", 32)
    predictor: Predictor = truth  # type: ignore[assignment]
    measured = measure_drawings(read_drawings(tmp_path)[0], predictor, 0, 1, print)
    assert len(measured.drawings) == 2
    (sentence,) = measured.left_out
    assert sentence.startswith("bad is left out: ")
    assert message in sentence


@pytest.mark.parametrize(
    ("index", "more", "message"),
    [
        (None, [], "which has no drawings.json"),
        ("[", [], "is not JSON"),
        ("[1]", [], "is not a list of drawings by name"),
        ("{}", [], "no drawing that can be measured; the file is empty"),
        ('{"a": 1}', [], "no drawing that can be measured; a in"),
        ("", ["--rows", "concepts"], "Did you mean concept"),
        ("", ["--seeds", "1"], "--human takes no --seeds"),
        ("", ["--evaluate", "none.onnx"], "none.onnx"),
    ],
)
def test_bad_input_is_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], index: str | None, more: list[str], message: str
) -> None:
    folder = tmp_path / "data"
    folder.mkdir()
    if index == "":
        write_drawings(folder)
    elif index is not None:
        (folder / "drawings.json").write_text(index)
    assert main(["benchmark", "--human", str(folder), "-o", str(tmp_path / "out"), *more]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()
