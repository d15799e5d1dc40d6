from pathlib import Path

import numpy as np
import pytest
from mesh_shapes import BALL, MESHES, angles, needs_meshes, solid, trimesh, write

from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.loading import read_triangles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile, find_meshes, read_orientations
from normalgan.rendering.renderers import EmbreeRenderer
from normalgan.rendering.repair import bodies

UP = np.array([0, 0, 1], dtype=np.float32)


def seen_from_behind(mesh: Mesh) -> float:
    """Return the share of visible pixels whose triangle is wound clockwise, over 14 directions."""
    behind = []
    for azimuth, elevation in [(a, e) for a in range(0, 360, 60) for e in (-40, 40)] + [(0, -90), (0, 90)]:
        camera = framed(mesh.vertices, look_at_origin(azimuth, elevation, 0), None, 0.02)
        shown = EmbreeRenderer().render(mesh, camera, 64)
        # As a negated copy of the normals is rendered flipped too, faces tell by which sign comes out.
        marked = Mesh(mesh.name, mesh.vertices, mesh.faces, np.zeros_like(mesh.normals) + UP)
        sign = EmbreeRenderer().render(marked, camera, 64).normal @ (camera.rotation @ [0, 0, 1])
        behind.append((sign[shown.mask] < 0).mean())
    return float(np.mean(behind))


@pytest.mark.parametrize("inside_out", [None, False, True])
def test_faces_wound_at_random_come_out_consistent(tmp_path: Path, inside_out: bool | None) -> None:
    rng = np.random.default_rng(0)
    two = trimesh.util.concatenate([BALL, BALL.copy().apply_translation([3, 0, 0])])
    faces = np.where(rng.random((len(two.faces), 1)) < 0.3, two.faces[:, ::-1], two.faces)
    path = write(tmp_path / "two.off", two.vertices, faces).path
    mesh = MeshFile(path, inside_out=inside_out).load()
    assert solid(mesh).is_winding_consistent
    assert (solid(mesh).volume < 0) == (inside_out is True)


def test_each_body_is_turned_outward_by_itself(tmp_path: Path) -> None:
    small = BALL.copy().apply_scale(0.3).apply_translation([2, 0, 0])
    small.invert()
    both = trimesh.util.concatenate([BALL, small])
    mesh = write(tmp_path / "bodies.off", both.vertices, both.faces).load()
    assert [part.volume > 0 for part in solid(mesh).split()] == [True, True]


@pytest.mark.parametrize("keep", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("inverted", [False, True])
def test_an_open_shell_is_turned_outward(tmp_path: Path, keep: float, inverted: bool) -> None:
    faces = BALL.faces[BALL.triangles_center[:, 2] < 2 * keep - 1]
    mesh = write(
        tmp_path / "shell.off", BALL.vertices + np.array([9, 0, 0]), faces[:, ::-1] if inverted else faces
    ).load()
    apex = mesh.normals[mesh.vertices[:, 2].argmin()]
    assert angles(apex, np.array([0, 0, -1])) < 5


def test_an_open_part_is_judged_from_its_own_middle_not_that_of_the_whole(tmp_path: Path) -> None:
    cap = BALL.submesh([BALL.triangles_center[:, 0] < -0.3], append=True).apply_translation([6, 0, 0])
    both = trimesh.util.concatenate([BALL, cap])
    mesh = write(tmp_path / "cap.off", both.vertices, both.faces).load()
    capped = mesh.vertices[:, 0] > 0.3
    apex = mesh.normals[capped][mesh.vertices[capped, 0].argmin()]
    assert angles(apex, np.array([-1, 0, 0])) < 5


def test_a_moebius_strip_is_taken_as_it_is(tmp_path: Path) -> None:
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=-1)
    across = 0.3 * (np.cos(turns / 2)[:, None] * ring + np.sin(turns / 2)[:, None] * [0, 0, 1])
    vertices = np.concatenate([ring - across, ring + across])
    quads = [(i, i + 1, i + 41, i + 40) for i in range(39)] + [(39, 40, 0, 79)]
    assert len(write(tmp_path / "strip.off", vertices, quads).load().faces) == 80


def test_neighbours_are_told_apart_from_bodies() -> None:
    body, turn = bodies(np.array([[0, 1, 2], [2, 1, 3], [1, 2, 4], [5, 6, 7], [6, 7, 8]]))
    assert (body[3] == body[4], body[0] == body[3], turn[3] != turn[4]) == (True, False, True)
    # Three faces meet in the edge 1-2, which joins none of them.
    assert len(set(body)) == 4


def test_seams_copies_and_rubbish_are_cleaned_away(tmp_path: Path) -> None:
    soup = BALL.vertices[BALL.faces].reshape(-1, 3)
    faces = np.arange(len(soup)).reshape(-1, 3)
    rubbish = [[0, 0, 1], faces[7][::-1].tolist(), faces[3].tolist(), [0, 1, 1]]
    extra = np.concatenate([soup, [[50.0, 50.0, 50.0]]])  # belongs to no face
    mesh = write(tmp_path / "soup.off", extra, [*faces.tolist(), *rubbish]).load()
    assert (len(mesh.vertices), len(mesh.faces)) == (642, 1280)
    assert angles(mesh.normals, mesh.vertices).max() < 1


@pytest.mark.parametrize(("crease_angle", "count"), [(None, 8), (100.0, 8), (89.0, 24), (0.0, 24)])
def test_edges_sharper_than_the_crease_angle_stay_hard(
    tmp_path: Path, crease_angle: float | None, count: int
) -> None:
    box = trimesh.creation.box()
    path = write(tmp_path / "box.off", box.vertices, box.faces).path
    mesh = MeshFile(path, crease_angle=crease_angle).load()
    assert len(mesh.vertices) == count
    if count == 24:
        a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
        flat = np.cross(b - a, c - a)
        for corner in range(3):
            assert angles(mesh.normals[mesh.faces[:, corner]], flat).max() < 1e-3
    else:  # angles, not triangles, are weighed: a cut along a diagonal does not tilt a corner
        np.testing.assert_allclose(np.abs(mesh.normals), 3**-0.5, atol=1e-6)


def test_a_cylinder_stays_round_between_hard_ends(tmp_path: Path) -> None:
    tube = trimesh.creation.cylinder(radius=1, height=1, sections=64)
    path = write(tmp_path / "tube.off", tube.vertices, tube.faces).path
    mesh = MeshFile(path, crease_angle=40).load()
    rim = np.linalg.norm(mesh.vertices[:, :2], axis=1) > 0.1
    upright = np.abs(mesh.normals[:, 2]) > 0.999
    round_ = mesh.vertices * [1, 1, 0]
    assert (rim & upright).sum() == (rim & ~upright).sum() == 128
    assert angles(mesh.normals[~upright], round_[~upright]).max() < 1e-2


@needs_meshes
def test_which_fourleg_meshes_are_inside_out_is_found_out() -> None:
    known = read_orientations(str(MESHES / "fourleg" / "orientation.json"))
    for mesh in find_meshes([str(MESHES / "fourleg" / f"{name}.off") for name in (381, 396, 398)]):
        vertices, faces = read_triangles(Path(mesh.path))
        assert (trimesh.Trimesh(vertices, faces, process=False).volume < 0) == known[mesh.name].inside_out
        assert solid(mesh.load()).volume > 0


@needs_meshes
@pytest.mark.parametrize("name", ["Alpaca", "Bull", "Deer", "Stag", "Wolf"])
def test_animals_of_open_parts_show_their_outside(name: str) -> None:
    (source,) = find_meshes(str(MESHES / "animals" / f"{name}.glb"))
    assert seen_from_behind(source.load()) < 1e-3
