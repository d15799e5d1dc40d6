"""Schemas: what the page sends, as pydantic checks it; fields that nobody knows are ignored."""

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

__all__ = [
    "Area",
    "DrawingFields",
    "ExportFields",
    "HintFields",
    "ImportQuery",
    "LayerFields",
    "MaskStrokeFields",
    "Plane",
    "PredictFields",
    "RequestFields",
    "Schema",
    "Side",
    "Structure",
    "SuggestFields",
    "parse",
    "parse_object",
]

_FARTHEST = 1e6
"""Pixels, or radians, of where a structure's tiles begin: none is seen farther off."""


class Schema(BaseModel):
    """A JSON object; its bytes are base64."""

    model_config = ConfigDict(strict=True, frozen=True, allow_inf_nan=False, val_json_bytes="base64")


S = TypeVar("S", bound=Schema)

_Share = Annotated[float, Field(ge=0, le=1)]
Side = Annotated[int, Field(ge=LEAST_SIDE, le=MOST_SIDE)]
"""Of a picture, in pixels."""
_Width = Annotated[float, Field(gt=0, le=MOST_SIDE)]
"""Of a brush, in pixels."""
_Vector = tuple[float, float, float]
_Points = Annotated[list[float], Field(min_length=2, max_length=2 * MOST_POINTS)]
"""x, y, x, y, … in pixels of the drawing."""
_Offset = Annotated[float, Field(ge=-_FARTHEST, le=_FARTHEST)]
_Number = Annotated[int, Field(ge=0, lt=2**53)]
"""Whole numbers below this are exact in JavaScript."""


class HintFields(Schema):
    """A pinned normal; ``reach`` in pixels says how far it works, and then the network does not see it."""

    x: float
    y: float
    normal: _Vector
    reach: Annotated[float, Field(ge=0, le=MOST_SIDE)] | None = None


class Structure(Schema):
    """A structure of the brush: one that is built in, or the ``picture`` of that name."""

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
            raise ValueError('a structure has a picture if its kind is "own", and else none')
        return self

    def scaled(self, scale: float) -> Placement:
        """Return where its tiles lie on a map, of which ``scale`` pixels are one of the drawing."""
        return Placement(self.period * scale, self.turn, self.x * scale, self.y * scale, self.flipped)


class Area(Schema):
    """A part of the map whose direction the user sets.

    Args:
        points: of a closed polygon, or of a stroke.
        normal: of length 1.
        size: width of the brush in pixels; None for a polygon, which is turned as a whole.
        form: of a polygon; None leaves it as predicted.
        soft: how much of a polygon's depth, or of the brush's radius, it fades over.
        strength: of the brush.
        smooths: whether the brush averages what is under it, and gives it no direction.
        height: of a line that stands out, or below 0 is cut in; None for a brush.
        widths: in pixels, of such a line at its points; None is size.
        structure: what the brush gives in place of a direction.
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
            raise ValueError("an area has points x, y, x, y, …: 3 or more, or 1 or more with a size")
        length = math.hypot(*self.normal)
        if not 0.75 < length < 1.25 or self.normal[2] < LEAST_Z * length:
            raise ValueError("the normal of an area has length 1, and its z is 0 or more")
        if self.widths is not None and len(self.widths) != count:
            raise ValueError("an area has as many widths as points")
        plain = self.size is not None and not self.smooths and self.height is None
        if self.structure is not None and not plain:
            raise ValueError("only a plain stroke, with a size, has a structure")
        return self

    @property
    def carves(self) -> bool:
        """Whether it is a line that stands out or is cut in."""
        return self.height is not None

    @property
    def fade(self) -> float:
        """The share of its depth, or of the brush's radius, in which it fades out."""
        if self.soft is not None:
            return self.soft
        return BRUSH_FADES if self.size is not None else FADES if self.form is None else 0

    @property
    def direction(self) -> Floats:
        """The normal (3,), unit."""
        return np.array(self.normal, np.float32) / np.float32(math.hypot(*self.normal))

    def line(self, scale: float) -> Floats:
        """Return the points (K, 2) on a map, of which ``scale`` pixels are one of the drawing."""
        return _pairs(self.points) * np.float32(scale)


class MaskStrokeFields(Schema):
    """A stroke of the mask brush, or with ``fills`` a click into an area."""

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
        """The stroke, in pixels of the drawing."""
        return MaskStroke(_pairs(self.points), self.size, self.adds, self.fills)


class Plane(Schema):
    """What part of a drawing's pixels follows the JSON: those of the box, left, top, right, bottom."""

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
    """A drawing: its picture or planes, and what was said of it.

    Args:
        picture: PNG; None if its pixels follow the JSON.
        planes: what part of them follows.
        base: number of the request whose pixels these are changes of; None for none.
        mask: PNG, white on the object.
        source: where the mask comes from, if it is not given.
        hints: pinned normals.
        areas: what is turned as a whole or brushed, in order.
        mask_strokes: what adds to the object or cuts from it, in order.
        form: of the whole drawing.
        structures: PNG of each picture that is a structure, white is high, by the name that areas give it.
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
    """A layer; ``bytes`` is how many of the pixels behind the JSON are its own."""

    id: Annotated[int, Field(ge=0, lt=2**31)]
    name: Annotated[str, Field(max_length=LONGEST_NAME)] = ""
    bytes: Annotated[int, Field(ge=0, le=MOST_BYTES)] = 0


class RequestFields(DrawingFields):
    """What every request about a drawing has: the drawing, in layers or not, and who asks.

    Args:
        tab: of the browser.
        number: of the request; of a tab's requests only the newest is answered.
        keep: whether later requests may send changes to these pixels.
        layers: the hindmost first; None for a drawing that is one.
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
    """A request for a map; ``longest`` is its longer side, and a draft gives way to newer requests."""

    longest: Side | None = None
    draft: bool = False
    changed_only: bool = False


class SuggestFields(RequestFields):
    """A request for places where hints would help."""

    count: Annotated[int, Field(ge=1, le=20)] = 5


class ExportFields(RequestFields):
    """A request for a file; ``size`` is the map's longer side; the pictures are PNG, for the zip of all."""

    what: str = "map"
    format: str | None = None
    y: Literal["up", "down"] = "up"
    alpha: bool = False
    size: Side | None = None
    name: Annotated[str, Field(min_length=1, max_length=LONGEST)] = "drawing"
    line_art: bytes | None = None
    lit_picture: bytes | None = None


class ImportQuery(Schema):
    """How a picture file is imported, and which page or frame of it."""

    way: Literal["drawing", "layers"] = Field("drawing", alias="as")
    part: Annotated[int, Field(ge=1, lt=10**8)] = 1


def parse(schema: type[S], content: bytes) -> S:
    """Return the object in a JSON text.

    Raises:
        InputError: if it is not one of the schema.
    """
    try:
        return schema.model_validate_json(content)
    except ValidationError as error:
        raise InputError(sentence_of(error)) from None


def parse_object(content: bytes) -> dict[str, Any]:
    """Return the fields of a JSON object, whatever they are.

    Raises:
        InputError: if it is none.
    """
    try:
        fields = from_json(content, allow_inf_nan=False)
    except ValueError as error:
        raise InputError(f"the request is not JSON: {error}.") from None
    if not isinstance(fields, dict):
        raise InputError("the request is not a JSON object with fields in braces.")
    return fields


def _pairs(points: Sequence[float]) -> Floats:
    """Return points (K, 2), none of them far off the drawing."""
    pairs = np.array(points, np.float32).reshape(-1, 2)
    return np.clip(pairs, -MOST_SIDE, 2 * MOST_SIDE)
