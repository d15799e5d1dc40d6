"""Scenes whose maps are known exactly: analytic surfaces, one ray a sample."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles, Floats
from normalgan.rendering.cameras import Camera
from normalgan.rendering.lines import LineDrawing
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.strokes import rasterise
from normalgan.rendering.view import View

Hit = tuple[Doubles, Doubles]  # depth (H, W), inf where missed; outward normal (H, W, 3)
Surface = Callable[[Doubles, Doubles], Hit]

EYE = 3.0
NOTHING = Mesh(
    "nothing", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32), np.zeros((0, 3), np.float32)
)


def look(
    *surfaces: Surface, size: int = 128, perspective: bool = False, shift: tuple[int, int] = (0, 0)
) -> Maps:
    """Cast the rays of 4 × 4 samples a pixel at the nearest of some analytic surfaces, frame ±1 at z = 0."""
    return cast(surfaces, 4 * size, perspective, (4 * shift[0], 4 * shift[1]))


def cast(
    surfaces: tuple[Surface, ...], side: int, perspective: bool = False, shift: tuple[int, int] = (0, 0)
) -> Maps:
    """Cast a ray a pixel at the nearest of some analytic surfaces, frame ±1 at z = 0, moved by pixels."""
    grid = (np.arange(side) + 0.5) * 2 / side - 1
    x, y = np.meshgrid(grid - shift[0] * 2 / side, -(grid - shift[1] * 2 / side))
    if perspective:
        origin = np.zeros((side, side, 3))
        ray = np.stack([x / EYE, y / EYE, -np.ones_like(x)], axis=-1)
    else:
        origin = np.stack([x, y, np.zeros_like(x)], axis=-1)
        ray = np.broadcast_to([0.0, 0.0, -1.0], origin.shape)
    depth, normal = np.full((side, side), np.inf), np.zeros((side, side, 3))
    for surface in surfaces:
        found, facing = surface(origin, ray)
        nearer = found < depth
        depth[nearer], normal[nearer] = found[nearer], facing[nearer]
    return Maps(normal.astype(np.float32), depth.astype(np.float32), np.isfinite(depth))


@dataclass(frozen=True)
class Scene(Renderer):
    """Casts rays at analytic surfaces, whatever the mesh."""

    surfaces: tuple[Surface, ...]

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        return cast(self.surfaces, size, camera.perspective)


@dataclass(frozen=True)
class Still(Renderer):
    """Returns the one picture it has, if it is of the size asked for."""

    maps: Maps

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        assert self.maps.mask.shape == (size, size)
        return self.maps


def view(*surfaces: Surface, size: int = 128, perspective: bool = False) -> View:
    """Return analytic surfaces, frame ±1 at z = 0, seen as a sketch of ``size`` pixels."""
    return View(NOTHING, front(perspective), Scene(surfaces), size)


def still(maps: Maps, size: int = 128, perspective: bool = False) -> View:
    """Return what has these maps, seen as a sketch of ``size`` pixels."""
    return View(NOTHING, front(perspective), Still(maps), size)


def front(perspective: bool) -> Camera:
    """Return the camera of all scenes."""
    half = 1 / EYE if perspective else 1.0
    return Camera(np.eye(3), np.array([0.0, 0.0, -EYE]), perspective, (-half, half, -half, half), 0.1, 9.0)


def ink(style: LineDrawing, seen: View) -> Floats:
    """Return the sketch of a view in a style."""
    return rasterise(style.trace(seen, np.random.default_rng(0)), seen.size)


def sphere(x: float, y: float, z: float, radius: float) -> Surface:
    def hit(origin: Doubles, ray: Doubles) -> Hit:
        centre = np.array([x, y, z - EYE])
        to, a = origin - centre, (ray * ray).sum(-1)
        b, c = (to * ray).sum(-1), (to * to).sum(-1) - radius**2
        inside = b * b - a * c
        depth = np.where(inside > 0, (-b - np.sqrt(np.maximum(inside, 0))) / a, np.inf)
        point = np.where(np.isfinite(depth), depth, 0)[..., None] * ray + to
        return depth, point / radius

    return hit


def plane(normal: tuple[float, float, float], half: float) -> Surface:
    """A square in the picture, on a plane through the frame's centre."""

    def hit(origin: Doubles, ray: Doubles) -> Hit:
        n = np.array(normal) / np.linalg.norm(normal)
        depth = ((np.array([0, 0, -EYE]) - origin) @ n) / (ray @ n)
        at = origin[..., :2] + EYE * ray[..., :2]
        depth = np.where(np.abs(at).max(-1) < half, depth, np.inf)
        return depth, np.broadcast_to(n, ray.shape)

    return hit


def cube(half: float) -> Surface:
    """A cube seen towards a corner."""
    a, b = np.deg2rad(35), np.deg2rad(25)
    about_y = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    turn = about_x @ about_y

    def hit(origin: Doubles, ray: Doubles) -> Hit:
        start, way = (origin + np.array([0, 0, EYE])) @ turn, ray @ turn
        sides = np.sort(np.stack([(-half - start) / way, (half - start) / way]), axis=0)
        enter, leave = sides[0].max(-1), sides[1].min(-1)
        axis = sides[0].argmax(-1)
        normal = np.eye(3)[axis] * -np.sign(way)
        return np.where(enter < leave, enter, np.inf), normal @ turn.T

    return hit


def bumps(amplitude: float) -> Surface:
    """A dome with rings of waves; orthographic only. `bump_slope` is its profile."""

    def hit(origin: Doubles, ray: Doubles) -> Hit:
        x, y = origin[..., 0], origin[..., 1]
        r = np.maximum(np.hypot(x, y), 1e-9)
        height = 0.5 * np.sqrt(np.maximum(0.64 - r * r, 1e-9)) + amplitude * np.cos(18 * r)
        slope = bump_slope(r, amplitude)
        normal = np.stack([-slope * x / r, -slope * y / r, np.ones_like(r)], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return np.where(r < 0.799, EYE - height, np.inf), normal

    return hit


def bump_slope(r: Doubles, amplitude: float) -> Doubles:
    """Return how steeply the dome of `bumps` rises at distance ``r`` from its axis."""
    slope: Doubles = -0.5 * r / np.sqrt(np.maximum(0.64 - r * r, 1e-9)) - 18 * amplitude * np.sin(18 * r)
    return slope
