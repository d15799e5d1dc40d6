import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from normalgan.animals.frames import bend, fold
from normalgan.animals.meshing import drop_crumbs, fill_voids, to_mesh, unit_sphere
from normalgan.animals.parts import Part
from normalgan.animals.shapes import Cut, Sweep, smooth_minimum


def capsule(radius: float, width: float, length: float = 1.0) -> Sweep:
    points = np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]])
    return Sweep(points, np.full(2, radius), np.full(2, width), np.tile([0.0, 0.0, 1.0], (2, 1)))


def test_a_round_segment_has_the_distance_of_a_capsule() -> None:
    axis = np.linspace(-1, 2, 13, dtype=np.float32)
    x, y, z = axis[:, None, None], axis[None, :, None], axis[None, None, :]
    clamped = np.clip(x, 0, 1)
    expected = np.sqrt((x - clamped) ** 2 + y**2 + z**2) - 0.3
    np.testing.assert_allclose(capsule(0.3, 0.3).distance(0, (x, y, z)), expected, atol=1e-5)


def test_a_flat_segment_vanishes_on_its_ellipse_with_unit_slope() -> None:
    sweep, step = capsule(0.4, 0.1), 1e-3
    for angle in np.linspace(0, 2 * np.pi, 9):
        y, z = 0.4 * np.sin(angle), 0.1 * np.cos(angle)
        normal = np.array([np.sin(angle) / 0.4, np.cos(angle) / 0.1])
        normal /= np.linalg.norm(normal)
        at = []
        for offset in (0.0, step):
            point = np.array([0.5, y + offset * normal[0], z + offset * normal[1]], np.float32)
            at.append(float(sweep.distance(0, (point[:1], point[1:2], point[2:]))[0]))
        assert at[0] == pytest.approx(0, abs=1e-5)
        assert (at[1] - at[0]) / step == pytest.approx(1, abs=0.05)


def test_a_meshed_capsule_has_its_volume() -> None:
    mesh = to_mesh("capsule", [Part((capsule(0.3, 0.3),), blend=0.0)])
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    scale = 0.8  # half of its length is the radius that becomes 1
    expected = (np.pi * 0.09 + 4 / 3 * np.pi * 0.027) / scale**3
    assert body.is_watertight
    assert body.volume == pytest.approx(expected, rel=0.02)


def test_a_carved_part_is_missing_and_a_cut_is_flat() -> None:
    whole = capsule(0.3, 0.3)
    plane = Cut(point=np.array([1.0, 0, 0]), normal=np.array([1.0, 0, 0]))
    cut = Sweep(whole.points, whole.radii, whole.widths, whole.sides, plane)
    dug = to_mesh("dug", [Part((cut,), 0.0), Part((capsule(0.1, 0.1, 2.0),), 0.0, carve=True)])
    # The hole along the axis leaves the flat end a ring; round it, the surface faces +x.
    end = dug.vertices[:, 0] > dug.vertices[:, 0].max() - 0.005
    assert np.mean(dug.normals[end, 0] > 0.95) > 0.6
    on_axis = np.hypot(dug.vertices[end, 1], dug.vertices[end, 2])
    assert on_axis.min() > 0.05


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.01, 0.5))
def test_the_smooth_minimum_is_symmetric_near_and_below_the_minimum(a: float, b: float, width: float) -> None:
    one, other = np.array([a], np.float32), np.array([b], np.float32)
    low = float(smooth_minimum(one, other, width)[0])
    assert low == float(smooth_minimum(other, one, width)[0])
    assert min(a, b) - width / 6 - 1e-6 <= low <= min(a, b) + 1e-6
    if abs(a - b) > width:
        assert low == pytest.approx(min(a, b), abs=1e-6)


def test_a_void_is_filled_and_the_outside_is_not() -> None:
    field = np.ones((9, 9, 9), np.float32)
    field[2:7, 2:7, 2:7] = -1
    field[4, 4, 4] = 1
    filled = fill_voids(field)
    assert filled[4, 4, 4] < 0
    assert filled[0, 0, 0] > 0
    assert np.sum(filled < 0) == 125


def test_a_crumb_is_dropped_and_a_body_is_not() -> None:
    field = np.ones((20, 9, 9), np.float32)
    field[2:7, 2:7, 2:7] = -1
    field[9:11, 4:6, 4:6] = -1
    field[13:18, 2:7, 2:7] = -1
    kept = drop_crumbs(field)
    assert np.sum(kept < 0) == 250
    assert kept[9, 4, 4] > 0


def test_the_unit_sphere_is_nearly_the_smallest() -> None:
    points = np.random.default_rng(0).normal(size=(500, 3))
    points = np.vstack([points / np.linalg.norm(points, axis=1, keepdims=True) * 0.9, np.eye(3), -np.eye(3)])
    moved = unit_sphere(points * 5 + [3.0, -2.0, 1.0])
    assert np.linalg.norm(moved, axis=1).max() == pytest.approx(1)
    np.testing.assert_allclose(moved, points, atol=0.03)


def test_bending_and_folding_keep_lengths() -> None:
    points = np.column_stack([np.linspace(0, 1, 6), np.linspace(0, 0.5, 6) ** 2, np.zeros(6)])
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    bent, turns = bend(points, up=40, left=-25)
    folded = fold(points, (0, 2), (30.0, -50.0))
    for moved in (bent, folded):
        np.testing.assert_allclose(np.linalg.norm(np.diff(moved, axis=0), axis=1), lengths)
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.tile(np.eye(3), (6, 1, 1)), atol=1e-12)
    assert bent[-1, 2] > 0  # turned to the right, +z
    assert folded[1, 1] > points[1, 1]
