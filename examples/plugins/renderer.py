"""A renderer, which maps a mesh and a camera to normals, depth and mask. It needs only NumPy."""

from dataclasses import dataclass

import numpy as np

from normalgan.rendering import RENDERERS, Camera, EmbreeRenderer, Maps, Renderer
from normalgan.rendering.mesh import Mesh
from normalgan.testing import check


@RENDERERS.register
@dataclass(frozen=True)
class BumpyRenderer(Renderer):
    """Embree's maps with noise on the normals, as a scanner might give them.

    Args:
        noise: standard deviation of each component.
    """

    noise: float = 0.005

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the maps of ``mesh`` as ``camera`` sees it."""
        maps = EmbreeRenderer().render(mesh, camera, size)
        bumps = np.random.default_rng(size).normal(0, self.noise, maps.normal.shape).astype(np.float32)
        normal = maps.normal + bumps * maps.mask[..., None]
        length = np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-6)
        return Maps(normal / length * maps.mask[..., None], maps.depth, maps.mask)


if __name__ == "__main__":
    check(BumpyRenderer())
