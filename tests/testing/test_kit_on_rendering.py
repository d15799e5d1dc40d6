from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.rendering import Camera, EmbreeRenderer, Maps, Mesh, Renderer
from normalgan.rendering.lines import LineDrawing, Silhouette
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View
from normalgan.testing import ConformanceError, check


@dataclass(frozen=True)
class Turned(Renderer):
    """Embree's maps, changed."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Any:
        maps = EmbreeRenderer().render(mesh, camera, size)
        return self.change(Maps(maps.normal.copy(), maps.depth.copy(), maps.mask.copy()), camera)

    def change(self, maps: Maps, camera: Camera) -> Any:
        return maps


class Tuple(Turned):
    """Returns no Maps."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return maps.normal, maps.depth, maps.mask


class Doubles(Turned):
    """Returns float64."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return replace(maps, normal=maps.normal.astype(np.float64))


class Long(Turned):
    """Forgets to normalise."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return replace(maps, normal=2 * maps.normal)


class Painted(Turned):
    """Paints the background as facing the viewer."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        maps.normal[~maps.mask] = [0, 0, 1]
        return maps


class Near(Turned):
    """Puts the background at depth 0."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        maps.depth[~maps.mask] = 0
        return maps


class Flipped(Turned):
    """Has y down in the picture."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return Maps(maps.normal[::-1].copy(), maps.depth[::-1].copy(), maps.mask[::-1].copy())


class Green(Turned):
    """Has y down in the vectors."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return replace(maps, normal=maps.normal * np.array([1, -1, 1], np.float32))


class World(Turned):
    """Gives normals of the world."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return replace(maps, normal=(maps.normal @ camera.rotation).astype(np.float32))


class Ray(Turned):
    """Counts depth from the near plane."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        return replace(maps, depth=(maps.depth - camera.near).astype(np.float32))


class Outward(Turned):
    """Lets the inside of a shell face away."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Any:
        maps = super().render(mesh, camera, size)
        if mesh.name == "bowl":
            return replace(maps, normal=-maps.normal)
        return maps


class Full(Turned):
    """Fails in a frame without the object."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        _ = maps.depth[maps.mask].min()
        return maps


class Noisy(Turned):
    """Adds noise that is not the same twice."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        noise = np.random.default_rng().normal(0, 1e-3, maps.depth.shape).astype(np.float32)
        return replace(maps, depth=maps.depth + noise)


class Seeds(Turned):
    """Seeds numpy for everybody."""

    def change(self, maps: Maps, camera: Camera) -> Any:
        np.random.seed(0)  # noqa: NPY002
        return maps


class Missing(Turned):
    """Needs what is not here."""

    def check(self) -> None:
        raise InputError("there is no OpenGL here.")


class Loose(Renderer):
    """Is no dataclass."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        return EmbreeRenderer().render(mesh, camera, size)


RENDERER_FAULTS = [
    (Tuple, "Tuple returned tuple; render must return Maps of size × size pixels"),
    (Doubles, r"Doubles returned normal \(33, 33, 3\) of float64 for 33 pixels; it must be .* of float32"),
    (Long, "Long rendered a normal whose length is 1 off from 1; normals on the object are unit vectors"),
    (Painted, "Painted rendered normals off the object; there they are zero"),
    (Near, "Near has a finite depth off the object; there it is infinite"),
    (
        Flipped,
        r"Flipped shares \d+% of the mask with the true orthographic one of an ellipsoid; the object must",
    ),
    (
        Green,
        r"Green is .*° off from the true orthographic normals of an ellipsoid; normals are in camera space",
    ),
    (World, r"World is .*° off from the true orthographic normals of an ellipsoid"),
    (Ray, "Ray is .* off from the true orthographic depth of an ellipsoid; depth is the distance"),
    (
        Outward,
        r"Outward turned 100% of the normals of an open shell away from the viewer; a surface seen from",
    ),
    (Full, "Full raised ValueError .* when asked for an empty view; a frame without the object"),
    (Noisy, "Noisy rendered the same twice differently; samples are kept by their settings alone"),
    (Seeds, "Seeds drew from or seeded numpy's global random state"),
    (Missing, "Missing raised InputError .there is no OpenGL here. when asked for running here"),
    (Loose, "Loose is no frozen dataclass; its fields are its settings, and enter the key"),
]


@pytest.mark.parametrize(("cls", "sentence"), RENDERER_FAULTS, ids=[c.__name__ for c, _ in RENDERER_FAULTS])
def test_a_fault_of_a_renderer_is_told(cls: type[Renderer], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


@dataclass(frozen=True)
class Redrawn(LineDrawing):
    """The silhouette, changed."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        return [self.change(s.points, s.width, rng) for s in Silhouette(resolution=96).trace(view, rng)]

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return Stroke(points, width, np.ones(len(points)))


class Points(Redrawn):
    """Returns points."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return points


class Unplaced(Redrawn):
    """Has a point that is no number."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return super().change(points * np.nan, width, rng)


class Magnified(Redrawn):
    """Forgets to go back to pixels of the sketch."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return super().change(points * 4, width, rng)


class Thin(Redrawn):
    """Has no width."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return super().change(points, 0 * width, rng)


class Black(Redrawn):
    """Inks in 8 bit."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return Stroke(points, width, np.full(len(points), 255.0))


class Nothing(Redrawn):
    """Draws nothing."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        return []


class Frame(Redrawn):
    """Draws a line along the edge of the paper."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        edge = Stroke.even(np.array([[0.0, 0.5], [view.size, 0.5]]), 2.0)
        return [*super().trace(view, rng), edge]


class Fills(Redrawn):
    """Draws a dot where there is nothing."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        middle = np.full(2, view.size / 2)
        return super().trace(view, rng) or [Stroke.even(np.stack([middle, middle + 1]), 2.0)]


class Expects(Redrawn):
    """Fails where there is nothing."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        _ = np.nonzero(view.maps().mask)[0].min()
        return super().trace(view, rng)


class Trembles(Redrawn):
    """Draws numbers of its own."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        return super().change(points + np.random.default_rng().normal(0, 0.1, points.shape), width, rng)


class Shakes(Redrawn):
    """Draws from numpy's global state."""

    def change(self, points: NDArray[Any], width: NDArray[Any], rng: np.random.Generator) -> Any:
        np.random.rand()  # noqa: NPY002
        return super().change(points, width, rng)


class Scribbles(Redrawn):
    """Writes into the maps of the view."""

    def trace(self, view: View, rng: np.random.Generator) -> Any:
        view.maps(2).depth[view.maps(2).mask] += 1
        return super().trace(view, rng)


LINE_FAULTS = [
    (Points, "Points returned list of ndarray; trace must return a list of Stroke in pixels of the sketch"),
    (Unplaced, "Unplaced traced a stroke whose points are no numbers; they must be finite"),
    (Magnified, r"Magnified traced a stroke from \d+ to \d+ pixels in a sketch of 96; points are in pixels"),
    (Thin, "Thin traced a stroke of width 0 or less; a pen has a width above 0"),
    (Black, r"Black traced a stroke of darkness .* to .*; darkness lies from 0, paper, to 1"),
    (Nothing, "Nothing drew nothing of an animal; every object must leave some ink"),
    (Frame, r"Frame put \d+% of its ink beside the animal; lines must lie on the object"),
    (Fills, "Fills drew something in a view that shows nothing; it must draw nothing there"),
    (Expects, "Expects raised ValueError .* when asked for an empty view; a view that shows nothing"),
    (Trembles, "Trembles traced the same view twice differently under one seed; the same view and rng"),
    (Shakes, "Shakes drew from or seeded numpy's global random state"),
    (Scribbles, "Scribbles changed the maps of the view; they belong to all styles"),
]


@pytest.mark.parametrize(("cls", "sentence"), LINE_FAULTS, ids=[c.__name__ for c, _ in LINE_FAULTS])
def test_a_fault_of_a_line_style_is_told(cls: type[LineDrawing], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=f"^{sentence}"):
        check(cls())


def test_those_without_a_fault_pass() -> None:
    check(Turned())
    check(Redrawn())
