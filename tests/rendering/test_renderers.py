import numpy as np
import pytest
from mesh_shapes import angles, blob, bowl, camera_at, ellipsoid
from numpy.typing import NDArray
from opengl_here import needs_opengl

from normalgan.rendering.cameras import Camera
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers import EmbreeRenderer, PyrenderRenderer, Renderer
from normalgan.testing.solids import exact_ellipsoid

both = pytest.mark.parametrize(
    "renderer",
    [EmbreeRenderer(), pytest.param(PyrenderRenderer(), marks=needs_opengl)],
    ids=["embree", "pyrender"],
)
projections = pytest.mark.parametrize("field_of_view", [None, 40.0], ids=["orthographic", "perspective"])


@both
@projections
@pytest.mark.parametrize("radii", [(1.0, 1.0, 1.0), (1.0, 0.6, 0.4)], ids=["sphere", "ellipsoid"])
def test_maps_are_those_of_the_true_surface(
    renderer: Renderer, field_of_view: float | None, radii: tuple[float, float, float]
) -> None:
    mesh = ellipsoid(*radii)
    camera = camera_at(mesh, field_of_view=field_of_view)
    maps, exact = renderer.render(mesh, camera, 256), exact_ellipsoid(radii, camera, 256)
    assert (maps.mask & exact.mask).sum() / (maps.mask | exact.mask).sum() > 0.99
    shared = maps.mask & exact.mask
    error = angles(maps.normal[shared], exact.normal[shared])
    assert error.mean() < 0.2
    assert np.sort(error)[-len(error) // 100 :].mean() < 2
    # The facets lie up to 4e-4 below the surface; near the silhouette depth is steep.
    sight = camera.rays(256)[1] @ camera.rotation.T
    facing = shared & (angles(exact.normal, -sight) < 70)
    np.testing.assert_allclose(maps.depth[facing], exact.depth[facing], atol=3e-3)


@needs_opengl
@projections
@pytest.mark.parametrize(("shape", "azimuth"), [(blob, 30), (blob, 140), (bowl, 20), (bowl, 75)])
def test_both_renderers_agree(shape: object, azimuth: float, field_of_view: float | None) -> None:
    mesh: Mesh = shape()  # type: ignore[operator]
    camera = camera_at(mesh, azimuth, field_of_view=field_of_view)
    one, other = EmbreeRenderer().render(mesh, camera, 256), PyrenderRenderer().render(mesh, camera, 256)
    assert (one.mask ^ other.mask).sum() <= 10
    shared = one.mask & other.mask
    # A pixel on the very edge between near and far may fall to either.
    same = shared & np.isclose(one.depth, other.depth, rtol=0, atol=1e-3)
    assert (shared & ~same).sum() <= 3
    assert angles(one.normal[same], other.normal[same]).mean() < 0.01


@both
def test_turning_faces_over_changes_nothing(renderer: Renderer) -> None:
    mesh, camera = blob(), camera_at(blob())
    turned = Mesh("turned", mesh.vertices, mesh.faces[:, ::-1].copy(), -mesh.normals)
    one, other = renderer.render(mesh, camera, 128), renderer.render(turned, camera, 128)
    shared = one.mask & other.mask
    assert (one.mask ^ other.mask).sum() <= 3
    assert (angles(one.normal[shared], other.normal[shared]) > 0.1).mean() < 1e-3


@both
def test_normals_that_cancel_give_way_to_the_flat_one(renderer: Renderer) -> None:
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], dtype=np.float32)
    mesh = Mesh("flat", vertices, np.array([[0, 1, 2]], dtype=np.int32), np.zeros((3, 3), dtype=np.float32))
    maps = renderer.render(mesh, camera_at(mesh, 0, 0, 0), 32)
    np.testing.assert_allclose(
        maps.normal[maps.mask], np.tile([0.0, 0.0, 1.0], (int(maps.mask.sum()), 1)), atol=1e-6
    )


@both
def test_an_object_half_outside_the_frame_or_behind_the_eye_is_cut(renderer: Renderer) -> None:
    whole = camera_at(ellipsoid(1, 1, 1), field_of_view=60)
    left, right, bottom, top = whole.window
    shifted = Camera(whole.rotation, whole.translation, True, (0.0, right, bottom, top), 0.01, whole.far)
    assert renderer.render(ellipsoid(1, 1, 1), shifted, 64).mask[:, 0].any()
    behind = Camera(whole.rotation, np.array([0, 0, 0.5]), True, (left, right, bottom, top), 0.01, whole.far)
    depth: NDArray[np.float32] = renderer.render(ellipsoid(1, 1, 1), behind, 64).depth
    assert 0 < depth.min() < depth.max() < 1.5 + 1e-3
