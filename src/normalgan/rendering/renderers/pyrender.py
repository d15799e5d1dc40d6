"""PyrenderRenderer: OpenGL without a display through EGL, on a graphics card if there is one."""

import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from normalgan.arrays import Doubles, Floats
from normalgan.errors import InputError, brief
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import RENDERERS, Renderer

# One context per process, because deleting a second one would delete the shared EGL display.
_context: "_FloatContext | None" = None


@RENDERERS.register
@dataclass(frozen=True)
class PyrenderRenderer(Renderer):
    """OpenGL through pyrender and EGL: faster than Embree for large pictures, but needs system libraries.

    Without a graphics card, Mesa's software driver is used. ``PYOPENGL_PLATFORM=egl``,
    ``PYGLET_HEADLESS=1`` and ``LP_NUM_THREADS=0`` are set unless already set in the environment. All
    rendering of a process must happen in one thread.
    """

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        """Return the maps of a mesh viewed by a camera; see `Renderer.render`.

        Raises:
            InputError: if OpenGL is not available.
        """
        pixels = _open_context().draw(mesh, camera, size)
        mask = pixels[..., 3] > 0
        depth = np.where(mask, pixels[..., 3], np.float32(np.inf))
        return Maps(normal=pixels[..., :3], depth=depth, mask=mask)

    def check(self) -> None:
        """Raise `InputError` if no OpenGL context can be created, with a message on what to install."""
        _open_context()


def _open_context() -> "_FloatContext":
    """Return the context of this process, created at the first call."""
    global _context  # noqa: PLW0603 -- see above
    if _context is None:
        os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
        os.environ.setdefault("PYGLET_HEADLESS", "1")  # otherwise unused pyglet requires X libraries
        # With several threads, Mesa's software driver hangs in forked processes.
        os.environ.setdefault("LP_NUM_THREADS", "0")
        platform = os.environ["PYOPENGL_PLATFORM"]
        if platform != "egl":
            raise InputError(
                f"PyrenderRenderer needs OpenGL through EGL, but PYOPENGL_PLATFORM is {platform!r}: "
                "unset it, or choose EmbreeRenderer."
            )
        try:
            with warnings.catch_warnings(action="ignore"):  # from packages that pyrender imports
                _context = _FloatContext()
        except Exception as error:  # missing libraries cause ImportError, AttributeError, AssertionError …
            raise InputError(
                f"PyrenderRenderer needs OpenGL through EGL ({type(error).__name__}: {brief(error)}): "
                "install libegl1 and libgl1 (Debian, Ubuntu), or choose EmbreeRenderer."
            ) from error
    return _context


_MOST_FRAMEBUFFERS = 3  # maximum number of framebuffers; one of 1024 pixels takes 20 MB


class _FloatFramebuffer:
    """A mixin for pyrender's ``Renderer`` with one float32 sample per pixel and our camera.

    pyrender itself multisamples and stores 8 bits, which blends the object with the background along
    silhouettes and shifts normals by 0.2°. Its cameras also cannot shift their window. This is a
    mixin, combined with pyrender's class in `_FloatContext`, so that this module can be imported without
    OpenGL.
    """

    viewport_width: int
    viewport_height: int
    camera: Camera
    _main_fb: Any
    _main_fb_ms: Any
    _main_cb: Any
    _main_db: Any
    _main_fb_dims: tuple[int | None, int | None]
    # Framebuffer, colours and depths by size. A sample needs maps of two sizes in turn, and creating
    # buffers each time would take as long as drawing.
    _kept: dict[tuple[int, int], tuple[Any, Any, Any]]

    def _get_camera_matrices(self, scene: Any) -> tuple[Doubles, Doubles]:
        return self.camera.view_matrix(), self.camera.projection_matrix()

    def _configure_main_framebuffer(self) -> None:
        from OpenGL import GL

        size = (self.viewport_width, self.viewport_height)
        if self._main_fb is not None and size == self._main_fb_dims:
            return
        if size not in self._kept:
            if len(self._kept) >= _MOST_FRAMEBUFFERS:
                self._delete_main_framebuffer()
            color, depth = GL.glGenRenderbuffers(2)
            self._kept[size] = (GL.glGenFramebuffers(1), color, depth)
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._kept[size][0])
            for buffer, kind, place in (
                (color, GL.GL_RGBA32F, GL.GL_COLOR_ATTACHMENT0),
                (depth, GL.GL_DEPTH_COMPONENT32F, GL.GL_DEPTH_ATTACHMENT),
            ):
                GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
                GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, kind, *size)
                GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
        self._main_fb, self._main_cb, self._main_db = self._kept[size]
        self._main_fb_ms = self._main_fb  # pyrender draws to the framebuffer with this name
        self._main_fb_dims = size

    def _delete_main_framebuffer(self) -> None:
        from OpenGL import GL

        for frame, color, depth in self._kept.values():
            GL.glDeleteFramebuffers(1, [frame])
            GL.glDeleteRenderbuffers(2, [color, depth])
        self._kept.clear()
        self._main_fb = self._main_fb_ms = self._main_cb = self._main_db = None
        self._main_fb_dims = (None, None)

    def _read_main_framebuffer(self, scene: Any, flags: int) -> Floats:
        """Return the shader's output (H, W, 4), with row 0 at the top."""
        from OpenGL import GL

        width, height = self._main_fb_dims
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._main_fb)
        pixels = GL.glReadPixels(0, 0, width, height, GL.GL_RGBA, GL.GL_FLOAT)
        return np.frombuffer(pixels, dtype=np.float32).reshape(self.viewport_height, -1, 4)[::-1]


class _FloatContext:
    """An OpenGL context with a float framebuffer and the last uploaded mesh.

    ``PYOPENGL_PLATFORM`` must be set before the first context is created.
    """

    def __init__(self) -> None:
        import pyrender
        from pyrender.renderer import Renderer
        from pyrender.shader_program import ShaderProgramCache

        self._offscreen = pyrender.OffscreenRenderer(64, 64)
        self._passes: Any = type("FloatRenderer", (_FloatFramebuffer, Renderer), {"_kept": {}})(64, 64)
        self._passes._program_cache = ShaderProgramCache(str(Path(__file__).parent / "shaders"))
        self._offscreen._renderer = self._passes
        # pyrender requires a camera in the scene, although its matrices are not used.
        self._scene = pyrender.Scene(bg_color=np.zeros(4))
        self._scene.add(pyrender.OrthographicCamera(1.0, 1.0))
        self._flags = pyrender.RenderFlags.FLAT | pyrender.RenderFlags.SKIP_CULL_FACES
        self._last: tuple[Mesh, Any] | None = None

    def draw(self, mesh: Mesh, camera: Camera, size: int) -> Floats:
        """Return the normal in camera space and the depth, (``size``, ``size``, 4); 0 outside the object."""
        if self._last is None or self._last[0] is not mesh:
            if self._last is not None:
                self._scene.remove_node(self._last[1])
            self._last = (mesh, self._scene.add(_uploadable(mesh)))
        self._passes.camera = camera
        self._offscreen.viewport_width = self._offscreen.viewport_height = size
        pixels: Floats = self._offscreen.render(self._scene, flags=self._flags)
        return pixels


def _uploadable(mesh: Mesh) -> Any:
    import pyrender

    # The default material would blend the object with the background.
    material = pyrender.MetallicRoughnessMaterial(alphaMode="OPAQUE")
    primitive = pyrender.Primitive(mesh.vertices, mesh.normals, indices=mesh.faces, material=material)
    return pyrender.Mesh([primitive])
