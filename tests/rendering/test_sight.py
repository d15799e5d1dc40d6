import numpy as np
from scenes import EYE, look, sphere

from normalgan.rendering.lines.sight import estimate_sight


def test_the_rays_are_recovered_from_the_maps() -> None:
    maps = look(sphere(-0.2, 0.1, 0.1, 0.5), sphere(0.3, -0.2, -0.4, 0.6), perspective=True)
    sight = estimate_sight(maps)
    centres = (np.arange(512) + 0.5) / 256 - 1
    np.testing.assert_allclose(sight.x, centres / EYE, atol=0.01)
    np.testing.assert_allclose(sight.y, -centres / EYE, atol=0.01)
    np.testing.assert_allclose(sight.pixel[maps.mask], maps.depth[maps.mask] / EYE / 256, rtol=0.02)
    flat = look(sphere(-0.2, 0.1, 0.1, 0.5), sphere(0.3, -0.2, -0.4, 0.6))
    np.testing.assert_allclose(estimate_sight(flat).pixel[flat.mask], 1 / 256, rtol=0.02)
    assert not estimate_sight(flat).x.any()
