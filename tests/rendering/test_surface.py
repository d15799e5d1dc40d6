import numpy as np
import pytest
from mesh_shapes import as_mesh, ellipsoid

from normalgan.arrays import Doubles
from normalgan.rendering.lines.surface import MeshSurface, shape_operators, smooth_normals
from normalgan.rendering.mesh import Mesh

AXES = np.array([1.0, 0.7, 0.5])


def ellipsoids_operators(points: Doubles) -> Doubles:
    """Return the exact shape operators of the ellipsoid: its Hessian over its gradient, on the tangents."""
    slope = points / AXES**2
    length = np.linalg.norm(slope, axis=1)
    normal = slope / length[:, None]
    flat = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    operators: Doubles = flat @ (np.diag(1 / AXES**2) / length[:, None, None]) @ flat
    return operators


def relative_errors(found: Doubles, true: Doubles) -> Doubles:
    errors: Doubles = np.linalg.norm(found - true, axis=(1, 2)) / np.linalg.norm(true, axis=(1, 2))
    return errors


def operators_of(mesh: Mesh, smoothing: float = 0.0) -> Doubles:
    surface = MeshSurface.of(mesh)
    return shape_operators(surface, smooth_normals(surface, smoothing), smoothing)


@pytest.mark.parametrize(("subdivisions", "median"), [(3, 0.02), (4, 0.008), (5, 0.004)])
def test_curvature_of_an_ellipsoid_nears_the_exact_one_as_faces_shrink(
    subdivisions: int, median: float
) -> None:
    mesh = ellipsoid(*AXES, subdivisions=subdivisions)
    errors = relative_errors(operators_of(mesh), ellipsoids_operators(mesh.vertices.astype(np.float64)))
    assert np.median(errors) < median
    assert errors.max() < 0.1


def test_smoothing_takes_noise_out_of_curvature() -> None:
    mesh = ellipsoid(*AXES, subdivisions=4)
    noise = 0.002 * np.random.default_rng(0).normal(size=mesh.vertices.shape)
    rough = as_mesh("rough", mesh.vertices + noise, mesh.faces)
    true = ellipsoids_operators(mesh.vertices.astype(np.float64))
    assert np.median(relative_errors(operators_of(rough), true)) > 0.1
    assert np.median(relative_errors(operators_of(rough, 0.1), true)) < 0.07


def test_curvature_shrinks_as_the_object_grows_and_turns_with_it() -> None:
    mesh = ellipsoid(*AXES, subdivisions=3)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    large = as_mesh("large", 3 * mesh.vertices.astype(np.float64) @ turn.T, mesh.faces)
    np.testing.assert_allclose(operators_of(large), turn @ operators_of(mesh) @ turn.T / 3, atol=2e-4)


def test_a_flat_sheet_and_a_face_without_area_have_no_curvature() -> None:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(20)], axis=1)
    corner = (np.arange(3)[:, None] * 5 + np.arange(4)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + 5], axis=1),
            np.stack([corner + 1, corner + 6, corner + 5], axis=1),
            [[0, 1, 2]],
        ]
    )
    up = np.tile(np.array([0, 0, 1], np.float32), (20, 1))
    sheet = Mesh("sheet", points.astype(np.float32), faces.astype(np.int32), up)
    np.testing.assert_allclose(operators_of(sheet), 0, atol=1e-9)


def test_slope_of_a_linear_field_is_its_tangent_part() -> None:
    mesh = ellipsoid(*AXES, subdivisions=5)
    surface = MeshSurface.of(mesh)
    direction = np.array([1.0, 2.0, 3.0])
    normal = surface.normals
    tangent = direction - normal * (normal @ direction)[:, None]
    np.testing.assert_allclose(surface.slope(surface.vertices @ direction), tangent, atol=0.03)


def test_every_edge_is_there_once_and_faces_know_theirs() -> None:
    surface = MeshSurface.of(ellipsoid(*AXES, subdivisions=2))
    assert len(surface.vertices) - len(surface.edges) + len(surface.faces) == 2  # Euler
    for corner in range(3):
        ends = np.sort(np.delete(surface.faces, corner, axis=1), axis=1)
        np.testing.assert_array_equal(surface.edges[surface.sides[:, corner]], ends)


@pytest.mark.parametrize("subdivisions", [4, 5])
def test_smoothing_spreads_as_far_as_it_says_whatever_the_mesh(subdivisions: int) -> None:
    mesh = ellipsoid(1, 1, 1, subdivisions=subdivisions)
    surface = MeshSurface.of(mesh)
    peak = np.zeros(len(surface.vertices))
    peak[0] = 1
    spread = surface.smooth(peak, 0.15)
    squares = ((surface.vertices - surface.vertices[0]) ** 2).sum(1)
    # Variance 0.15² along each of two directions of the surface.
    assert np.sqrt((spread * squares).sum() / spread.sum() / 2) == pytest.approx(0.15, rel=0.15)
    np.testing.assert_allclose(surface.smooth(np.ones(len(surface.vertices)), 0.15), 1)
