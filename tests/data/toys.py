"""Plug-ins and meshes small enough for tests; in a module, so that worker processes can import them."""

import os
import signal
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from normalgan.errors import InputError
from normalgan.rendering.cameras import Camera, Views
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.samples import Recipe, Sample
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View


@dataclass(frozen=True)
class Octahedron:
    """A mesh source that costs nothing; ``flaw`` makes it unusable, ``stretch`` makes it another mesh."""

    name: str
    stretch: float = 0.5
    flaw: str = ""

    def fingerprint(self) -> str:
        return f"octahedron {self.stretch} {self.flaw}"

    def load(self) -> Mesh:
        if self.flaw:
            raise InputError(f"{self.name} {self.flaw}.")
        axes = np.vstack([np.eye(3), -np.eye(3)]).astype(np.float32)
        faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
        vertices = axes * np.array([1, self.stretch, self.stretch], np.float32)
        return Mesh(self.name, vertices, np.array(faces, np.int32), axes)


@dataclass(frozen=True)
class BallRenderer(Renderer):
    """Draws a ball whose place in the frame depends on mesh and camera.

    Args:
        radius: of the ball.
        dies_at: a deadly mesh.
        waits_at: a mesh that is not rendered until the file ``until`` is there.
        until: that file.
    """

    radius: float = 0.5
    dies_at: str = ""
    waits_at: str = ""
    until: str = ""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        if mesh.name == self.dies_at:
            os.kill(os.getpid(), signal.SIGKILL)
        while mesh.name == self.waits_at and not Path(self.until).exists():
            time.sleep(0.01)
        steps = (np.arange(size) + 0.5) / size * 2 - 1
        x0, y0 = 0.3 * camera.rotation[:2, 0] * mesh.vertices[1, 1]
        x, y = np.meshgrid(steps - x0, -steps - y0)
        inside = x**2 + y**2 < self.radius**2
        z = np.sqrt(np.clip(self.radius**2 - x**2 - y**2, 0, None))
        normal = np.where(inside[..., None], np.stack([x, y, z], -1) / self.radius, 0)
        return Maps(normal.astype(np.float32), np.where(inside, 3 - z, np.inf).astype(np.float32), inside)

    def check(self) -> None:
        if self.radius <= 0:
            raise InputError("this machine has no room for a ball.")


@dataclass(frozen=True)
class RimDrawing(LineDrawing):
    """Inks the pixels of the object that face the viewer least."""

    threshold: float = 0.4
    supersampling: int = 2

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        maps = view.maps(self.supersampling)
        rim = maps.mask & (maps.normal[..., 2] < self.threshold)
        rows, columns = np.nonzero(rim)
        points = (np.stack([columns, rows], axis=1) + 0.5) / self.supersampling
        nib = np.array([0.25, 0.0])  # a dot is a line as long as half a pixel
        return [Stroke.even(np.stack([point - nib, point + nib]), 0.5) for point in points]


def recipe(size: int = 16, seed: int = 0, **renderer: object) -> Recipe:
    return Recipe(Views(), BallRenderer(**renderer), RimDrawing(), size, seed)  # type: ignore[arg-type]


def samples(count: int, size: int = 16) -> list[Sample]:
    mesh = Octahedron("toy").load()
    return [recipe(size).render(mesh, index) for index in range(count)]


def surroundings(_: int) -> tuple[str | None, bool, int]:
    return os.environ.get("OMP_NUM_THREADS"), "torch" in sys.modules, os.getpid()


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file under a folder but those still being written."""
    files = (p for p in sorted(folder.rglob("*")) if p.is_file() and ".partial" not in p.parts)
    return {str(p.relative_to(folder)): p.read_bytes() for p in files}


def assert_same(a: Sample, b: Sample) -> None:
    for name in ("sketch", "normal", "mask"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
        assert getattr(a, name).dtype == getattr(b, name).dtype


@dataclass
class Counted:
    """An octahedron that notes how often it is loaded."""

    name: str
    loads: list[str] = field(default_factory=list)

    def fingerprint(self) -> str:
        return self.name

    def load(self) -> Mesh:
        self.loads.append(self.name)
        return Octahedron(self.name).load()
