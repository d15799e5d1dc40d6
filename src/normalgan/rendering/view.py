"""View: an object and a camera, with maps at any size that a line style needs."""

from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps, check_maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import Renderer


class View:
    """An object viewed by a camera.

    Args:
        mesh: mesh of the object.
        camera: camera of the view.
        renderer: renderer of the maps.
        size: side of the sketch and of the normal map in pixels.
    """

    def __init__(self, mesh: Mesh, camera: Camera, renderer: Renderer, size: int) -> None:
        self.mesh = mesh
        self.camera = camera
        self.renderer = renderer
        self.size = size
        self._maps: dict[int, Maps] = {}

    def maps(self, scale: int = 1) -> Maps:
        """Return the maps at ``scale`` times the sketch's size; each size is rendered only once."""
        if scale not in self._maps:
            size = scale * self.size
            rendered = self.renderer.render(self.mesh, self.camera, size)
            self._maps[scale] = check_maps(self.renderer, rendered, size)
        return self._maps[scale]
