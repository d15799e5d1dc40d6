import numpy as np
import pytest
import trimesh

from normalgan.animals.frames import Frame, pitch, yaw
from normalgan.animals.meshing import to_mesh
from normalgan.animals.parts import Part
from normalgan.animals.shapes import Box, Ellipsoid, Plate, Ring, Solid, outline_distance, rounded

FRAME = Frame(np.array([0.3, -0.2, 0.5]), yaw(35) @ pitch(-50))
SOLIDS = [
    (Ellipsoid(FRAME, np.array([0.9, 0.6, 0.4])), 4 / 3 * np.pi * 0.9 * 0.6 * 0.4),
    # A box swept by a ball: its core, six slabs, twelve quarter tubes, eight eighths of the ball.
    (
        Box(FRAME, np.array([0.9, 0.6, 0.5]), 0.2),
        8 * 0.7 * 0.4 * 0.3
        + 8 * 0.2 * (0.7 * 0.4 + 0.4 * 0.3 + 0.3 * 0.7)
        + 2 * np.pi * 0.04 * (0.7 + 0.4 + 0.3)
        + 4 / 3 * np.pi * 0.008,
    ),
    (Ring(FRAME, 0.8, 0.3), 2 * np.pi**2 * 0.8 * 0.09),
]
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
PLANE = Frame(np.array([0.2, -0.1, 0.3]), yaw(35) @ pitch(20))


def sampled(solid: Solid, points: np.ndarray) -> np.ndarray:
    """Distances at scattered points, (n,)."""
    x, y, z = (points[:, i].astype(np.float32)[:, None, None] for i in range(3))
    return solid.distance((x, y, z))[:, 0, 0]


@pytest.mark.parametrize(("solid", "volume"), SOLIDS, ids=["ellipsoid", "box", "ring"])
def test_a_meshed_solid_has_its_volume_and_lies_in_its_box(solid: Solid, volume: float) -> None:
    mesh = to_mesh("solid", [Part((solid,), 0.0)], 12_000)
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    low, high = solid.reach()
    # The mesh is scaled to unit radius; its extent against that of the box gives the scale back.
    scale = float(np.max(high - low) / np.max(np.ptp(mesh.vertices, axis=0)))
    assert body.is_watertight
    assert body.volume * scale**3 == pytest.approx(volume, rel=0.03)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0) * scale, high - low, rtol=0.03)
    assert 9_000 <= len(mesh.faces) <= 16_000


@pytest.mark.parametrize(("solid", "volume"), SOLIDS, ids=["ellipsoid", "box", "ring"])
def test_a_mirrored_or_placed_solid_is_the_same_solid_elsewhere(solid: Solid, volume: float) -> None:
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (400, 3))
    own = sampled(solid, points)
    assert own.min() < 0 < own.max()
    np.testing.assert_allclose(sampled(solid.mirrored(), points * [1, 1, -1]), own, atol=1e-5)
    frame = Frame(np.array([1.0, 2.0, 3.0]), yaw(70) @ pitch(20))
    np.testing.assert_allclose(
        sampled(solid.placed(frame, 2.0), frame.place(points * 2.0)), own * 2, atol=2e-5
    )


def at(plate: Plate, point: np.ndarray) -> float:
    x, y, z = point.astype(np.float32).reshape(3, 1, 1, 1)
    return float(plate.distance((x, y, z))[0, 0, 0])


def test_the_distance_to_a_concave_outline_is_that_of_its_nearest_edge() -> None:
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    u, v = np.array([0.5, 1.5, 1.5, 3.0], np.float32), np.array([1.5, 1.5, 0.5, 2.0], np.float32)
    # Inside, in the notch, inside, and off the corner at (2, 1).
    np.testing.assert_allclose(outline_distance(corner, u, v), [-0.5, 0.5, -0.5, np.sqrt(2)], atol=1e-6)


def test_a_flat_plate_is_as_thick_as_it_says() -> None:
    plate = Plate(PLANE, SQUARE, rim=0.1)
    for local, distance in (
        ((0, 0, 0.25), 0.15),
        ((0, 0, 0), -0.1),
        ((1.2, 0, 0), 0.2),
        ((0.5, -0.5, -0.1), 0.0),
    ):
        assert at(plate, PLANE.place(np.array([local]))[0]) == pytest.approx(distance, abs=1e-5)


def test_a_bowed_plate_runs_through_its_parabola() -> None:
    plate = Plate(PLANE, SQUARE, rim=0.05, bow=(0.8, 0.0))
    for u in (-0.7, 0.0, 0.4):
        assert at(plate, PLANE.place(np.array([[u, 0.1, 0.4 * u * u]]))[0]) == pytest.approx(-0.05, abs=1e-5)


def test_the_image_of_a_plate_is_on_the_other_side() -> None:
    plate = Plate(PLANE, SQUARE * [1.0, 0.6], rim=0.1, bow=(0.5, -0.2))
    points = np.random.default_rng(0).normal(size=(20, 3))
    for point in points:
        assert at(plate, point) == pytest.approx(at(plate.mirrored(), point * [1, 1, -1]), abs=1e-5)


def test_the_box_of_a_plate_holds_its_inside() -> None:
    plate = Plate(PLANE, SQUARE, rim=0.1, bow=(0.9, 0.6))
    low, high = plate.reach()
    axes = [np.linspace(-3, 3, 61, dtype=np.float32)] * 3
    inside = plate.distance((axes[0][:, None, None], axes[1][None, :, None], axes[2][None, None, :])) < 0
    points = np.argwhere(inside) * 0.1 - 3.0
    assert len(points) > 100
    assert (points >= low - 1e-6).all()
    assert (points <= high + 1e-6).all()


def test_a_thin_plate_is_meshed_whole() -> None:
    mesh = to_mesh("leaf", [Part((Plate(PLANE, rounded([(0, 0), (2, 0.3), (0.4, 1)]), rim=1e-4),), 0.0)])
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert body.is_watertight
    assert body.body_count == 1
    assert body.euler_number == 2  # no holes worn through


def test_cutting_corners_keeps_an_outline_within_itself() -> None:
    smooth = rounded([(0, 0), (1, 0), (1, 1), (0, 1)])
    assert len(smooth) == 16
    assert smooth.min() == 0.0
    assert smooth.max() == 1.0
    assert not any(np.allclose(point, (0, 0)) for point in smooth)
