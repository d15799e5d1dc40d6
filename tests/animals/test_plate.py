import numpy as np
import pytest
import trimesh

from normalgan.animals.field import Part
from normalgan.animals.frames import Frame, pitch, yaw
from normalgan.animals.meshing import to_mesh
from normalgan.animals.plate import Plate, outline_distance, rounded

SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
TURNED = Frame(np.array([0.2, -0.1, 0.3]), yaw(35) @ pitch(20))


def at(plate: Plate, point: np.ndarray) -> float:
    x, y, z = point.astype(np.float32).reshape(3, 1, 1, 1)
    return float(plate.distance(x, y, z)[0, 0, 0])


def test_the_distance_to_a_concave_outline_is_that_of_its_nearest_edge() -> None:
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    u, v = np.array([0.5, 1.5, 1.5, 3.0], np.float32), np.array([1.5, 1.5, 0.5, 2.0], np.float32)
    # Inside, in the notch, inside, and off the corner at (2, 1).
    np.testing.assert_allclose(outline_distance(corner, u, v), [-0.5, 0.5, -0.5, np.sqrt(2)], atol=1e-6)


def test_a_flat_plate_is_as_thick_as_it_says() -> None:
    plate = Plate(SQUARE, TURNED, rim=0.1)
    for local, distance in (
        ((0, 0, 0.25), 0.15),
        ((0, 0, 0), -0.1),
        ((1.2, 0, 0), 0.2),
        ((0.5, -0.5, -0.1), 0.0),
    ):
        assert at(plate, TURNED.place(np.array([local]))[0]) == pytest.approx(distance, abs=1e-5)


def test_a_bowed_plate_runs_through_its_parabola() -> None:
    plate = Plate(SQUARE, TURNED, rim=0.05, bow=(0.8, 0.0))
    for u in (-0.7, 0.0, 0.4):
        assert at(plate, TURNED.place(np.array([[u, 0.1, 0.4 * u * u]]))[0]) == pytest.approx(-0.05, abs=1e-5)


def test_the_image_of_a_plate_is_on_the_other_side() -> None:
    plate = Plate(SQUARE * [1.0, 0.6], TURNED, rim=0.1, bow=(0.5, -0.2))
    points = np.random.default_rng(0).normal(size=(20, 3))
    for point in points:
        assert at(plate, point) == pytest.approx(at(plate.mirrored(), point * [1, 1, -1]), abs=1e-5)


def test_the_box_of_a_plate_holds_its_inside() -> None:
    plate = Plate(SQUARE, TURNED, rim=0.1, bow=(0.9, 0.6))
    low, high = plate.reach()
    axes = [np.linspace(-3, 3, 61, dtype=np.float32)] * 3
    inside = plate.distance(axes[0][:, None, None], axes[1][None, :, None], axes[2][None, None, :]) < 0
    points = np.argwhere(inside) * 0.1 - 3.0
    assert len(points) > 100
    assert (points >= low - 1e-6).all()
    assert (points <= high + 1e-6).all()


def test_a_thin_plate_is_meshed_whole() -> None:
    mesh = to_mesh(
        "leaf", [Part((), 0.0, solids=(Plate(rounded([(0, 0), (2, 0.3), (0.4, 1)]), TURNED, rim=1e-4),))]
    )
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
