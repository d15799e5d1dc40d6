"""Renderer: turns a mesh and a camera into maps."""

from abc import ABC, abstractmethod

from normalgan.registry import Registry
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh

__all__ = ["RENDERERS", "Renderer"]


class Renderer(ABC):
    """Base of the renderers.

    A renderer is a frozen dataclass that uses NumPy only. Its fields are its settings; they and the file
    that defines the class, but not what that file imports, enter the key under which rendered samples
    are stored. Anything it opens (an OpenGL context) belongs to the process, not to
    the object, so that it can be handed to a worker process.
    """

    @abstractmethod
    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the `Maps` of a mesh seen by a camera, ``size`` × ``size`` pixels.

        One sample a pixel at its centre, never blended with the background. A surface seen from behind
        (through a hole of an open shell) gets the normal that faces the viewer.
        """

    def check(self) -> None:
        """Raise `InputError` if this machine lacks a requirement of the renderer; say what to install."""


RENDERERS: Registry[Renderer] = Registry(Renderer, "normalgan.renderers")  # type: ignore[type-abstract]
