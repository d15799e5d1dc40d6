"""Samples: sketches with true normal maps, created by a reproducible recipe."""

import dataclasses
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.files.source_hash import source_hash
from normalgan.ranges import PositiveInt, check_ranges
from normalgan.rendering.cameras import Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines.base import LineDrawing, check_strokes
from normalgan.rendering.maps import Maps
from normalgan.rendering.media import Medium
from normalgan.rendering.mesh import Mesh, check_mesh
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.strokes.raster import rasterise
from normalgan.rendering.view import View

RENDERING_VERSION = 2
"""Version of the rendering. Increase it if a code change affects samples, so that they are created again."""


@dataclass(frozen=True)
class Sample:
    """A stored view of a mesh; row 0 is the top of the picture.

    Args:
        sketch: (H, W) ink, from 0 (paper) to 255.
        normal: (H, W, 3) unit normals in camera space (x right, y up, z to the viewer), 0 outside the
            object. Half precision changes them by less than 0.05°.
        mask: (H, W), True on the object.
        hints: (H, W, 4): normals of the sample's own hints and hint mask; None without hints.
    """

    sketch: NDArray[np.uint8]
    normal: NDArray[np.float16]
    mask: BoolMask
    hints: NDArray[np.float16] | None = None


@dataclass(frozen=True)
class Recipe:
    """Recipe for samples of a mesh; it creates the same samples in any order and on any machine.

    Args:
        views: distribution of camera views.
        renderer: renderer of the maps.
        lines: line style of the sketch.
        size: side of the pictures in pixels.
        seed: seed of the views and of all other randomness.
        hand: model of a person's drawing hand; None draws exact lines.
        medium: pen, paper and scanner; None draws clean ink on white paper.
    """

    noun: ClassVar[str] = "mesh"
    hints: ClassVar[bool] = False

    views: Views
    renderer: Renderer
    lines: LineDrawing
    size: PositiveInt = 256
    seed: int = 0
    hand: Hand | None = None
    medium: Medium | None = None

    def __post_init__(self) -> None:
        check_ranges(self)

    def check(self) -> None:
        """Raise `InputError` if this machine lacks a requirement of the renderer."""
        self.renderer.check()

    def render(self, mesh: Mesh, index: int) -> Sample:
        """Return the view of a mesh at an index; it does not depend on other views.

        Raises:
            InputError: if ``mesh`` is not a mesh, or the style finds no lines in the view.
        """
        mesh = check_mesh(mesh)
        rng = partial(sample_rng, self.seed, mesh.name, index)
        view = View(mesh, self.views.camera(mesh, rng("views")), self.renderer, self.size)
        strokes, maps = draw_strokes(view, self.lines, self.hand, rng)
        if not strokes:
            raise no_lines(self.lines, f"{mesh.name}, view {index}", self.size)
        ink = draw_ink(strokes, self.size, self.medium, rng)
        return Sample(
            sketch=np.rint(255 * ink).astype(np.uint8),
            normal=maps.normal.astype(np.float16),
            mask=maps.mask.astype(np.bool_),
        )

    def describe(self) -> dict[str, Any]:
        """Return everything except the mesh that the samples depend on, as plain values for JSON.

        Raises:
            TypeError: if a plug-in is not a dataclass of plain values, so its settings cannot be saved.
        """
        return {**_plain(self), "rendering_version": RENDERING_VERSION}


def draw_strokes(
    view: View, lines: LineDrawing, hand: Hand | None, rng: Callable[[str], np.random.Generator]
) -> tuple[list[Stroke], Maps]:
    """Return the strokes of a drawing and its maps, both changed by the hand.

    Args:
        view: view to draw.
        lines: line style.
        hand: model of a drawing hand; None draws exact lines.
        rng: function that returns the random generator of a step, ``lines`` or ``hand``.

    Returns:
        The strokes, possibly none, and the maps.
    """
    strokes = list(check_strokes(lines, lines.trace(view, rng("lines")), view.size))
    maps = view.maps()
    return hand.draw(strokes, maps, rng("hand")) if hand is not None and strokes else (strokes, maps)


def no_lines(lines: LineDrawing, seen: str, size: int) -> InputError:
    """Return the error for a view where a style finds no strokes, because a blank sheet is not a drawing."""
    return InputError(
        f"{type(lines).__name__} finds no lines in {seen}: there it is thinner than a pixel of {size}, "
        "or every line is shorter than the style allows."
    )


def draw_ink(
    strokes: Sequence[Stroke], size: int, medium: Medium | None, rng: Callable[[str], np.random.Generator]
) -> Floats:
    """Return strokes as ink, (size, size) from 0 to 1.

    Args:
        strokes: strokes of the drawing.
        size: H and W.
        medium: pen, paper and scanner; None draws clean ink.
        rng: function that returns the random generator of a step, ``medium``.
    """
    ink = rasterise(strokes, size)
    return ink if medium is None else medium.apply(ink, rng("medium"))


def sample_rng(seed: int, name: str, index: int, step: str) -> np.random.Generator:
    """Return the random generator of one step for one view of a mesh, the same in all processes.

    Each step has its own generator, so steps do not affect each other's random numbers.

    Args:
        seed: seed of the recipe.
        name: name of the mesh.
        index: index of the view.
        step: ``views`` (the camera), ``lines`` (the style), ``hand`` or ``medium``.

    Example:
        >>> a, b = sample_rng(0, "horse", 3, "views"), sample_rng(0, "horse", 3, "views")
        >>> bool(a.random() == b.random() != sample_rng(0, "horse", 3, "lines").random())
        True
    """
    # Python's hash() would differ between processes, because it is salted.
    digest = hashlib.sha256(json.dumps([seed, name, index, step]).encode()).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))


def _plain(value: Any) -> Any:
    """Return dataclasses as dicts with their class name, sequences as lists, and plain values unchanged."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
        code = source_hash(type(value))  # otherwise an edited plug-in would reuse its old samples
        return {"class": type(value).__name__, **({"code": code} if code else {}), **fields}
    raise TypeError(
        f"{type(value).__name__} is not a dataclass of plain values: samples made by it cannot be told apart."
    )
