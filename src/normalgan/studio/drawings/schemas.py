"""Schemas: pydantic models of what the page sends; unknown fields are ignored."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import from_json

from normalgan.arrays import Floats
from normalgan.errors import InputError, sentence_of
from normalgan.inference.edits import BRUSH_FADES, FADES, MaskStroke
from normalgan.inference.forms import Form
from normalgan.inference.structures import Kind, Placement
from normalgan.normals import LEAST_Z
from normalgan.studio.drawings.limits import (
    LEAST_PERIOD,
    LEAST_SIDE,
    LONGEST_NAME,
    MOST_AREAS,
    MOST_CARVED,
    MOST_HINTS,
    MOST_LAYERS,
    MOST_MASK_STROKES,
    MOST_PERIOD,
    MOST_POINTS,
    MOST_SIDE,
    MOST_STRUCTURES,
)
from normalgan.studio.names import LONGEST
from normalgan.studio.server.bodies import MOST_BYTES

_FARTHEST = 1e6
"""Maximum offset, in pixels, and rotation, in radians, of a structure's tiles."""


class Schema(BaseModel):
    """Base class of JSON objects; bytes are encoded as base64."""

    model_config = ConfigDict(strict=True, frozen=True, allow_inf_nan=False, val_json_bytes="base64")


S = TypeVar("S", bound=Schema)

_Share = Annotated[float, Field(ge=0, le=1)]
Side = Annotated[int, Field(ge=LEAST_SIDE, le=MOST_SIDE)]
"""Side of a picture in pixels."""
_Width = Annotated[float, Field(gt=0, le=MOST_SIDE)]
"""Width of a brush in pixels."""
_Vector = tuple[float, float, float]
_Points = Annotated[list[float], Field(min_length=2, max_length=2 * MOST_POINTS)]
"""Points as x, y, x, y, … in pixels of the drawing."""
_Offset = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST)]
_Number = Annotated[int, Field(ge=0, lt=2**53)]
"""Number of a request; integers below 2**53 are exact in JavaScript."""


class HintFields(Schema):
    """A pinned normal; with a ``reach`` in pixels, it acts as an edit that the network does not see."""

    x: float
    y: float
    normal: _Vector
    reach: Annotated[float, Field(ge=0, le=MOST_SIDE)] | None = None


class Structure(Schema):
    """A structure applied by the brush: a built-in one, or the user's ``picture`` of that name."""

    kind: Kind | Literal["own"]
    period: Annotated[float, Field(ge=LEAST_PERIOD, le=MOST_PERIOD)]
    turn: _Offset = 0
    x: _Offset = 0
    y: _Offset = 0
    flipped: bool = False
    picture: str | None = None

    @model_validator(mode="after")
    def _is_built_in_or_a_picture(self) -> Self:
        if (self.kind == "own") != (self.picture is not None):
            raise ValueError('a structure has a picture if, and only if, its kind is "own"')
        return self

    def scaled(self, scale: float) -> Placement:
        """Return the placement of the tiles on a map with ``scale`` pixels per pixel of the drawing."""
        return Placement(self.period * scale, self.turn, self.x * scale, self.y * scale, self.flipped)


class Area(Schema):
    """An edit of the map: a polygon, a brush stroke or a carved line.

    Args:
        points: points of a closed polygon or of a stroke.
        normal: direction of the area, a unit vector.
        size: width of the brush in pixels; None for a polygon, which is tilted rigidly.
        form: form of a polygon; None leaves it as predicted.
        soft: width of the fade, as a fraction of a polygon's depth or of the brush's radius; None is the
            default.
        strength: strength of the edit.
        smooths: whether the brush smooths the normals instead of setting a direction.
        height: relative height of a carved line, negative for a groove; None for a brush.
        widths: width of a carved line at each point in pixels; None uses ``size``.
        structure: structure that the brush applies instead of a direction.
    """

    points: _Points
    normal: _Vector
    size: _Width | None = None
    form: Form | None = None
    soft: _Share | None = None
    strength: _Share = 1
    smooths: bool = False
    height: Annotated[float, Field(ge=-1, le=1)] | None = None
    widths: list[_Width] | None = None
    structure: Structure | None = None

    @model_validator(mode="after")
    def _goes_together(self) -> Self:
        count, odd = divmod(len(self.points), 2)
        if odd or (self.size is None and count < 3):
            raise ValueError("the points of an area are x, y, x, y, …; it needs 3, or 1 with a size")
        length = math.hypot(*self.normal)
        if not 0.75 < length < 1.25 or self.normal[2] < LEAST_Z * length:
            raise ValueError("the normal of an area must have length 1, and its z must be 0 or more")
        if self.widths is not None and len(self.widths) != count:
            raise ValueError("an area must have as many widths as points")
        plain = self.size is not None and not self.smooths and self.height is None
        if self.structure is not None and not plain:
            raise ValueError("only a plain stroke with a size can have a structure")
        return self

    @property
    def carves(self) -> bool:
        """Whether the area is a carved line."""
        return self.height is not None

    @property
    def fade(self) -> float:
        """The width of the fade, as a fraction of the polygon's depth or of the brush's radius."""
        if self.soft is not None:
            return self.soft
        return BRUSH_FADES if self.size is not None else FADES if self.form is None else 0

    @property
    def direction(self) -> Floats:
        """The unit normal (3,)."""
        return np.array(self.normal, np.float32) / np.float32(math.hypot(*self.normal))

    def line(self, scale: float) -> Floats:
        """Return the points (K, 2) on a map with ``scale`` pixels per pixel of the drawing."""
        return _pairs(self.points) * np.float32(scale)


class MaskStrokeFields(Schema):
    """A stroke of the mask brush or, with ``fills``, a click that fills an area."""

    points: _Points
    size: _Width
    adds: bool
    fills: bool = False

    @model_validator(mode="after")
    def _has_pairs(self) -> Self:
        if len(self.points) % 2:
            raise ValueError("a stroke has points x, y, x, y, …")
        return self

    @property
    def stroke(self) -> MaskStroke:
        """The stroke in pixels of the drawing."""
        return MaskStroke(_pairs(self.points), self.size, self.adds, self.fills)


class Plane(Schema):
    """The part of a drawing's pixels that follows the JSON: ``box`` is left, top, right, bottom."""

    name: Literal["ink"]
    width: Side
    height: Side
    channels: Literal[1, 4]
    box: tuple[int, int, int, int]

    @model_validator(mode="after")
    def _has_a_box_inside(self) -> Self:
        left, top, right, bottom = self.box
        if not (0 <= left <= right <= self.width and 0 <= top <= bottom <= self.height):
            raise ValueError("the box of a plane is left, top, right, bottom, within its width and height")
        return self


class DrawingFields(Schema):
    """A drawing: its picture or planes, its mask, and the user's hints and edits.

    Args:
        picture: a PNG; None if pixels follow the JSON.
        planes: the part of the pixels that follows the JSON.
        base: number of the request whose pixels are changed; None if all pixels follow.
        mask: a PNG, white on the object.
        source: mask source if no mask is given.
        hints: pinned normals.
        areas: edited areas and strokes, in chronological order.
        mask_strokes: strokes of the mask brush, in chronological order.
        form: form of the whole drawing; None leaves it as predicted.
        structures: height pictures (PNG, white is high) of the user's structures, by the names used in areas.
    """

    picture: bytes | None = None
    planes: Annotated[tuple[Plane, ...], Field(max_length=1)] = ()
    base: _Number | None = None
    mask: bytes | None = None
    source: Literal["outline", "model"] | None = None
    hints: Annotated[tuple[HintFields, ...], Field(max_length=MOST_HINTS)] = ()
    areas: tuple[Area, ...] = ()
    mask_strokes: Annotated[tuple[MaskStrokeFields, ...], Field(max_length=MOST_MASK_STROKES)] = ()
    form: Form | None = None
    structures: Annotated[dict[str, bytes], Field(max_length=MOST_STRUCTURES)] = {}

    @model_validator(mode="after")
    def _has_no_more_areas_than_a_layer(self) -> Self:
        carved = sum(area.carves for area in self.areas)
        if len(self.areas) - carved > MOST_AREAS or carved > MOST_CARVED:
            raise ValueError(
                f"there are {len(self.areas) - carved} areas and {carved} carved lines; "
                f"a layer has at most {MOST_AREAS} and {MOST_CARVED}"
            )
        missing = {area.structure.picture for area in self.areas if area.structure} - {None, *self.structures}
        if missing:
            raise ValueError(f"there is no picture {sorted(map(str, missing))[0]!r} among the structures")
        return self


class LayerFields(DrawingFields):
    """A layer; ``bytes`` is the size of its part of the pixels that follow the JSON."""

    id: Annotated[int, Field(ge=0, lt=2**31)]
    name: Annotated[str, Field(max_length=LONGEST_NAME)] = ""
    bytes: Annotated[int, Field(ge=0, le=MOST_BYTES)] = 0


class RequestFields(DrawingFields):
    """Fields of every request about a drawing.

    Args:
        tab: identifier of the browser tab.
        number: number of the request; only the newest request of a tab is answered.
        keep: whether later requests may send changes to these pixels.
        layers: the layers, back to front; None for a drawing without layers.
    """

    tab: Annotated[str, Field(min_length=1, max_length=48)]
    number: _Number
    keep: bool = True
    layers: Annotated[tuple[LayerFields, ...], Field(min_length=1, max_length=MOST_LAYERS)] | None = None

    @model_validator(mode="after")
    def _tells_layers_apart(self) -> Self:
        ids = [layer.id for layer in self.layers or ()]
        if len(set(ids)) < len(ids):
            raise ValueError("two layers have the same id")
        if len(ids) > 1 and not all(layer.name for layer in self.layers or ()):
            raise ValueError("a layer among others has a name")
        return self


class PredictFields(RequestFields):
    """A request for a map; ``longest`` is the map's longer side, and a ``draft`` yields to newer requests."""

    longest: Side | None = None
    draft: bool = False
    changed_only: bool = False


class SuggestFields(RequestFields):
    """A request for points where hints would help."""

    count: Annotated[int, Field(ge=1, le=20)] = 5


class ExportFields(RequestFields):
    """A request for a file; ``size`` is the map's longer side, and the pictures are PNGs for the zip file."""

    what: str = "map"
    format: str | None = None
    y: Literal["up", "down"] = "up"
    alpha: bool = False
    size: Side | None = None
    name: Annotated[str, Field(min_length=1, max_length=LONGEST)] = "drawing"
    line_art: bytes | None = None
    colours: bytes | None = None
    lit_picture: bytes | None = None


class ImportQuery(Schema):
    """Query parameters of an import."""

    way: Literal["drawing", "layers"] = Field("drawing", alias="as")
    part: Annotated[int, Field(ge=1, lt=10**8)] = 1


def parse(schema: type[S], content: bytes) -> S:
    """Return the object of a JSON text.

    Raises:
        InputError: if the text does not match the schema.
    """
    try:
        return schema.model_validate_json(content)
    except ValidationError as error:
        raise InputError(sentence_of(error)) from None


def parse_object(content: bytes) -> dict[str, Any]:
    """Return the fields of any JSON object.

    Raises:
        InputError: if the text is not a JSON object.
    """
    try:
        fields = from_json(content, allow_inf_nan=False)
    except ValueError as error:
        raise InputError(f"the request is not JSON: {error}.") from None
    if not isinstance(fields, dict):
        raise InputError("the request is not a JSON object with fields in braces.")
    return fields


def _pairs(points: Sequence[float]) -> Floats:
    """Return points as (K, 2), clipped to the surroundings of the drawing."""
    pairs = np.array(points, np.float32).reshape(-1, 2)
    return np.clip(pairs, -MOST_SIDE, 2 * MOST_SIDE)
