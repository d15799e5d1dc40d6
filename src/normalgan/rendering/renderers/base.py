"""Renderer: base class of renderers, which return the maps of a mesh."""

from abc import ABC, abstractmethod

from normalgan.ranges import RangeChecked
from normalgan.registry import Registry
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh


class Renderer(RangeChecked, ABC):
    """Base class of renderers.

    A renderer is a frozen dataclass that does not use torch. Its fields are its settings. The cache key of
    rendered samples covers them and the source file of the class, but not the imports of that file.
    Resources such as an OpenGL context must belong to the process instead of the object, so that it can be
    sent to a worker process.
    """

    @abstractmethod
    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the `Maps` of a mesh viewed by a camera, ``size`` × ``size`` pixels.

        Maps are sampled once per pixel at its centre, never blended with the background. A surface viewed
        from behind (through a hole of an open shell) gets the normal that faces the viewer.
        """

    def check(self) -> None:
        """Raise `InputError`, with advice on what to install, if this machine lacks a requirement."""


RENDERERS: Registry[Renderer] = Registry(Renderer, "normalgan.renderers")  # type: ignore[type-abstract]
