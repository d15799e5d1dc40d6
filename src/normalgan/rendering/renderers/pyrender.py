"""PyrenderRenderer: OpenGL without a display, through EGL; on a graphics card if there is one."""

import os
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from normalgan.errors import InputError, brief
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import RENDERERS, Renderer

if TYPE_CHECKING:
    from normalgan.rendering.renderers.float_framebuffer import FloatContext

__all__ = ["PyrenderRenderer"]

# One context for the process: deleting a second one would delete the shared EGL display.
_context: "FloatContext | None" = None


@RENDERERS.register
@dataclass(frozen=True)
class PyrenderRenderer(Renderer):
    """OpenGL through pyrender and EGL; faster than Embree from 512 pixels on; needs system libraries.

    Without a graphics card, Mesa's software driver renders. ``PYOPENGL_PLATFORM=egl``,
    ``PYGLET_HEADLESS=1`` and ``LP_NUM_THREADS=0`` are set unless the environment sets them. All rendering
    of a process must happen in one thread.
    """

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the maps of ``mesh`` seen by ``camera``; see `Renderer.render`.

        Raises:
            InputError: if OpenGL is not available.
        """
        pixels = _open_context().draw(mesh, camera, size)
        mask = pixels[..., 3] > 0
        depth = np.where(mask, pixels[..., 3], np.float32(np.inf))
        return Maps(normal=pixels[..., :3], depth=depth, mask=mask)

    def check(self) -> None:
        """Raise `InputError` if no OpenGL context can be made; say what to install."""
        _open_context()


def _open_context() -> "FloatContext":
    """Return this process's context, made at the first call."""
    global _context  # noqa: PLW0603 -- see above
    if _context is None:
        os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
        os.environ.setdefault("PYGLET_HEADLESS", "1")  # else pyglet, never used here, asks for X libraries
        # With several threads, Mesa's software driver hangs in forked processes.
        os.environ.setdefault("LP_NUM_THREADS", "0")
        platform = os.environ["PYOPENGL_PLATFORM"]
        if platform != "egl":
            raise InputError(
                f"PyrenderRenderer needs OpenGL through EGL, but PYOPENGL_PLATFORM is {platform!r}: "
                "unset it, or choose EmbreeRenderer."
            )
        try:
            with warnings.catch_warnings(action="ignore"):  # of packages that pyrender imports
                from normalgan.rendering.renderers.float_framebuffer import FloatContext

                _context = FloatContext()
        except Exception as error:  # missing libraries show as ImportError, AttributeError, AssertionError …
            raise InputError(
                f"PyrenderRenderer needs OpenGL through EGL ({type(error).__name__}: {brief(error)}): "
                "install libegl1 and libgl1 (Debian, Ubuntu), or choose EmbreeRenderer."
            ) from error
    return _context
