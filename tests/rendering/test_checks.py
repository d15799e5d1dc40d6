"""What sources, renderers and line styles of somebody else give: a wrong thing is one sentence."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from normalgan.animals import Animal
from normalgan.errors import InputError
from normalgan.rendering import Camera, EmbreeRenderer, Maps, Renderer, Views
from normalgan.rendering.lines import LineDrawing, Mixture
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.samples import Recipe, draw_strokes
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View


@dataclass(frozen=True)
class Odd(LineDrawing):
    """Gives whatever it is told to."""

    give: Any

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        return self.give  # type: ignore[no-any-return]


@dataclass(frozen=True)
class OddRenderer(Renderer):
    """Changes what Embree gives."""

    give: Callable[[Maps], Any]

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        maps: Maps = self.give(EmbreeRenderer().render(mesh, camera, size))
        return maps


@pytest.fixture(scope="module")
def seen() -> tuple[Mesh, Camera]:
    """An animal and a camera."""
    mesh = Animal("horse", 1).load()
    return mesh, Views().camera(mesh, np.random.default_rng(0))


def line(*ends: float, width: float = 1.0) -> Stroke:
    return Stroke.even(np.array([[ends[0], 5.0], [ends[1], 5.0]]), width)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (None, r"^Odd gave NoneType; a line style gives a list of Stroke\.$"),
        ([np.zeros((3, 2))], r"^Odd gave list of ndarray; a line style gives a list of Stroke\.$"),
        ([line(0, 9), "line"], r"^Odd gave list of str; a line style gives a list of Stroke\.$"),
        ([line(0, np.nan)], r"^Odd gave a stroke whose points are not numbers; they must be finite\.$"),
        ([line(0, 9, width=np.inf)], r"^Odd gave a stroke whose width are not numbers"),
        # Cut up into pixels these would take all memory there is.
        (
            [line(0, 1e9)],
            r"^Odd gave a stroke from 0 to 1e\+09 pixels, up to 1 wide, for a sketch of 32; poi",
        ),
        ([line(-40, 9)], r"^Odd gave a stroke from -40 to 9 pixels"),
        ([line(0, 9, width=1e6)], r"^Odd gave a stroke from 0 to 9 pixels, up to 1e\+06 wide"),
    ],
    ids=[
        "nothing",
        "arrays",
        "a word among them",
        "no numbers",
        "endless width",
        "far away",
        "far to the left",
        "wide",
    ],
)
def test_a_line_style_that_gives_no_such_strokes_is_named(
    seen: tuple[Mesh, Camera], given: Any, sentence: str
) -> None:
    view = View(*seen, EmbreeRenderer(), 32)
    with pytest.raises(InputError, match=sentence):
        draw_strokes(view, Odd(given), None, lambda _: np.random.default_rng(0))


@pytest.mark.parametrize(
    ("give", "sentence"),
    [
        (lambda maps: None, r"^OddRenderer gave NoneType; a renderer gives normalgan\.rendering\.Maps\.$"),
        (
            lambda maps: replace(maps, normal=maps.normal[::2]),
            r"^OddRenderer gave a normal of shape \(16, 32, 3\); here it is an array of shape \(32, 32",
        ),
        (
            lambda maps: replace(maps, depth=None),
            r"^OddRenderer gave a depth of NoneType; here it is an array",
        ),
        (
            lambda maps: replace(maps, mask=maps.mask.astype(np.float32)),
            r"^OddRenderer gave a mask of float32; it is bool, True on the object\.$",
        ),
        (lambda maps: replace(maps, normal=maps.normal * np.nan), r"gave normals that are not numbers; give"),
    ],
    ids=["nothing", "half of it", "no depth", "a soft mask", "no numbers"],
)
def test_a_renderer_that_gives_no_such_maps_is_named(
    seen: tuple[Mesh, Camera], give: Callable[[Maps], Any], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        View(*seen, OddRenderer(give), 32).maps()


@dataclass(frozen=True)
class Named(Odd):
    """Another style that gives whatever it is told to."""


def test_a_wrong_style_of_a_mixture_is_named_and_not_the_mixture(seen: tuple[Mesh, Camera]) -> None:
    view = View(*seen, EmbreeRenderer(), 32)
    mixed = Mixture([Odd([line(0, 9)]), Named(None)], [0, 1])
    with pytest.raises(InputError, match=r"^Named gave NoneType; a line style gives a list of Stroke\.$"):
        draw_strokes(view, mixed, None, lambda _: np.random.default_rng(0))


@pytest.mark.parametrize(
    ("give", "sentence"),
    [
        (lambda mesh: None, r"^its load gave NoneType; it must be a normalgan\.rendering\.Mesh\.$"),
        (lambda mesh: (mesh.vertices, mesh.faces), r"^its load gave tuple; it must be a"),
        (
            lambda mesh: replace(mesh, vertices=mesh.vertices.tolist()),
            r"^its load gave a Mesh whose vertices are not an array of \(V, 3\) finite floats\.$",
        ),
        (
            lambda mesh: replace(mesh, normals=mesh.normals * np.nan),
            r"^its load gave a Mesh whose normals are not an array of \(V, 3\) finite floats\.$",
        ),
        (
            lambda mesh: replace(mesh, faces=mesh.faces[:0]),
            r"^its load gave a Mesh whose faces are not an array of \(F, 3\) whole numbers\.$",
        ),
        (
            lambda mesh: replace(mesh, normals=mesh.normals[:7]),
            r"^its load gave a Mesh of \d+ vertices and 7 normals; each vertex has one\.$",
        ),
        (
            lambda mesh: replace(mesh, faces=mesh.faces + 1),
            r"^its load gave a Mesh whose faces name the vertices 1 to (\d+); it has 0 to \d+\.$",
        ),
    ],
    ids=["nothing", "a tuple", "lists", "no numbers", "no face", "few normals", "faces from 1"],
)
def test_a_source_that_loads_no_such_mesh_is_told(
    seen: tuple[Mesh, Camera], give: Callable[[Mesh], Any], sentence: str
) -> None:
    recipe = Recipe(Views(), EmbreeRenderer(), Odd([]), size=32)
    with pytest.raises(InputError, match=sentence):
        recipe.render(give(seen[0]), 0)
