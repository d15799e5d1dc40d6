import numpy as np
import pytest
from mesh_shapes import blob, camera_at
from scenes import EYE, front, look, sphere

from normalgan.rendering.lines.buffers import sight
from normalgan.rendering.renderers import EmbreeRenderer

WHOLE = (slice(0, 512), slice(0, 512))


def test_rays_and_pixels_are_those_of_the_frame() -> None:
    maps = look(sphere(-0.2, 0.1, 0.1, 0.5), sphere(0.3, -0.2, -0.4, 0.6), perspective=True)
    seen = sight(front(perspective=True), maps, WHOLE, 512)
    centres = (np.arange(512) + 0.5) / 256 - 1
    np.testing.assert_allclose(seen.x, centres / EYE, atol=1e-6)
    np.testing.assert_allclose(seen.y, -centres / EYE, atol=1e-6)
    np.testing.assert_allclose(seen.pixel[maps.mask], maps.depth[maps.mask] / EYE / 256, rtol=1e-5)
    flat = look(sphere(-0.2, 0.1, 0.1, 0.5))
    seen = sight(front(perspective=False), flat, WHOLE, 512)
    np.testing.assert_allclose(seen.pixel, 1 / 256, rtol=1e-6)
    assert not seen.x.any()
    assert not seen.y.any()


@pytest.mark.parametrize("field_of_view", [None, 40.0])
def test_depth_and_rays_give_back_the_surface(field_of_view: float | None) -> None:
    # Independently: the pixel next door, on a plane through the first, is where depth and rays say.
    camera = camera_at(blob(), field_of_view=field_of_view)
    maps = EmbreeRenderer().render(blob(), camera, 64)
    window = (slice(10, 60), slice(5, 50))
    part = type(maps)(maps.normal[window], maps.depth[window], maps.mask[window])
    seen = sight(camera, part, window, 64)
    origins, directions = camera.rays(64)
    depth = np.where(part.mask, part.depth, 0)
    world = (origins[window] + depth[..., None] * directions[window])[part.mask]
    point = (world @ camera.rotation.T + camera.translation)[:, :2]
    rows, columns = np.nonzero(part.mask)
    if camera.perspective:
        ray = np.stack([seen.x[columns], seen.y[rows]], axis=1)
        np.testing.assert_allclose(ray * depth[part.mask][:, None], point, atol=1e-5)
    step = (camera.window[1] - camera.window[0]) / 64
    expected = step * (depth[part.mask] if camera.perspective else 1)
    np.testing.assert_allclose(seen.pixel[part.mask], expected, rtol=1e-5)
