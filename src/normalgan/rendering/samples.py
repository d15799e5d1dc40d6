"""Samples: a sketch and the normal map it was drawn from, made by a recipe that can be repeated."""

import dataclasses
import hashlib
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.views import Views

RENDERING_VERSION = 1
"""Raise it when a change to the code changes what a recipe renders: stored samples are then made anew."""


@dataclass(frozen=True)
class Sample:
    """What is stored of one view of one mesh; row 0 is the top of the picture.

    Args:
        sketch: (H, W) ink, from 0 (paper) to 255.
        normal: (H, W, 3) unit normals in camera space (x right, y up, z to the viewer), 0 off the object;
            half precision turns them by less than 0.05°.
        mask: (H, W) True on the object.
    """

    sketch: NDArray[np.uint8]
    normal: NDArray[np.float16]
    mask: NDArray[np.bool_]


@dataclass(frozen=True)
class Recipe:
    """How samples are made of a mesh: the same recipe makes the same samples, in any order, anywhere.

    Args:
        views: where the object is looked at from.
        renderer: what turns a mesh and a camera into normals.
        lines: the style in which the sketch is drawn.
        size: side of the pictures in pixels.
        seed: another seed gives other views.

    Raises:
        InputError: if the size is not positive.
    """

    views: Views
    renderer: Renderer
    lines: LineDrawing
    size: int = 256
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse a picture without pixels."""
        if self.size < 1:
            raise InputError(f"size is {self.size}; it is the side of the pictures in pixels, at least 1.")

    def render(self, mesh: Mesh, index: int) -> Sample:
        """Return view number ``index`` of ``mesh``; it depends on no other view."""
        camera = self.views.camera(mesh, sample_rng(self.seed, mesh.name, index))
        maps = self.renderer.render(mesh, camera, self.size)
        scale = self.lines.supersampling
        # The normals are rendered at their own size: averaged down, they would blend across contours.
        large = maps if scale == 1 else self.renderer.render(mesh, camera, scale * self.size)
        ink = self.lines.draw(large, self.size)
        return Sample(
            sketch=np.rint(255 * np.clip(ink, 0, 1)).astype(np.uint8),
            normal=maps.normal.astype(np.float16),
            mask=maps.mask.astype(np.bool_),
        )

    def describe(self) -> dict[str, Any]:
        """Return all that the samples depend on besides the mesh, as plain values for JSON.

        Raises:
            TypeError: if a plug-in is not a dataclass of plain values, so that its settings cannot be told.
        """
        return {**_plain(self), "rendering_version": RENDERING_VERSION}


def sample_rng(seed: int, name: str, index: int) -> np.random.Generator:
    """Return the source of randomness of one view of one mesh, the same in every process and release.

    Example:
        >>> a, b = sample_rng(0, "horse", 3), sample_rng(0, "horse", 3)
        >>> bool(a.random() == b.random() != sample_rng(0, "horse", 4).random())
        True
    """
    # Not Python's hash(): it is salted anew in every process.
    digest = hashlib.sha256(json.dumps([seed, name, index]).encode()).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))


def _plain(value: Any) -> Any:
    """Return dataclasses as dicts with their class name, sequences as lists, plain values as they are."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {"class": type(value).__name__, **fields}
    raise TypeError(
        f"{type(value).__name__} is not a dataclass of plain values: samples made by it cannot be told apart."
    )
