"""DrawingRequest: the picture, hints and mask of a request."""

import hashlib
import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import groupby
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.edits import (
    REACH,
    MaskStroke,
    brush,
    carve,
    enforce_pins,
    paint_mask,
    polygon,
    smooth,
    stroke,
    tilt,
)
from normalgan.inference.forms import KINDS, Form, feather, give_form
from normalgan.inference.mask.masks import MODEL, OUTLINE, MaskOrSource, MaskSource, mask_of
from normalgan.inference.reading.hint_files import Hints, parse_hints
from normalgan.inference.reading.picture import Picture, read_picture
from normalgan.inference.structures import KINDS as STRUCTURES
from normalgan.inference.structures import Placement, Tile, impress, read_tile
from normalgan.normals import LEAST_Z
from normalgan.studio.fields import Fields, take_bytes, take_choice
from normalgan.studio.limits import (
    LEAST_PERIOD,
    LEAST_SIDE,
    MOST_AREAS,
    MOST_CARVED,
    MOST_HINTS,
    MOST_MASK_STROKES,
    MOST_PERIOD,
    MOST_POINTS,
    MOST_SIDE,
    MOST_STRUCTURES,
    TILE_SIDE,
)

__all__ = [
    "Area",
    "DrawingRequest",
    "Structure",
    "check_sides",
    "read_areas",
    "read_form",
    "read_png",
    "read_structure",
    "take_drawing",
    "to_picture",
]

_SOFT = 0.01
"""Width of the edge of an area that does not fade out, as a share of the map's longer side."""
_FADES = 0.5
"""The share of its depth in which an area without a form fades out, unless it says how far."""
_BRUSH_FADES = 0.6
"""The share of its radius in which a stroke of the brush fades out, unless it says how far."""
_OWN = "own"
"""Kind of a structure that is a picture."""
_FARTHEST = 1e6
"""Pixels, or radians, of where a structure's tiles begin: none is seen farther off."""
_INKED = 0.35
"""How dark a line is at least that parts one area from another."""
_PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class DrawingRequest:
    """The drawing of a request, not decoded yet.

    Args:
        picture: PNG, or pixels (H, W, 1), grey, or (H, W, 4), with opacity.
        hints: list of x, y and normal.
        mask: PNG, white on the object; or where it comes from, as for
            `normalgan.inference.preparation.prepare`.
        areas: list of what is turned as a whole or brushed, as `read_areas` takes it.
        mask_strokes: list of strokes that add to the object or cut from it, as `read_mask` takes them.
        form: of the whole drawing, as `read_form` takes it; None leaves it as predicted.
        structures: PNG of each picture that is a structure, white is high, by the name that areas give it.
    """

    picture: bytes | NDArray[np.uint8]
    hints: Any
    mask: bytes | MaskSource | None
    areas: Any = ()
    mask_strokes: Any = ()
    form: Any = None
    structures: Mapping[str, bytes] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def shape(self) -> tuple[int, ...] | None:
        """(H, W), if it came as pixels."""
        return None if isinstance(self.picture, bytes) else self.picture.shape[:2]

    @property
    def drawn(self) -> bool:
        """Whether it is strokes alone, and no picture was imported."""
        return not isinstance(self.picture, bytes) and self.picture.shape[-1] == 1

    def digest(self) -> bytes:
        """Return a hash of the drawing."""
        by_hand = json.dumps([self.hints, self.areas, self.form]).encode()
        own = b"".join(name.encode() + content for name, content in self.structures.items())
        return hashlib.sha256(self.lines_digest() + hashlib.sha256(by_hand).digest() + own).digest()

    def lines_digest(self) -> bytes:
        """Return a hash of the drawing without its hints, areas, form and structures."""
        whole = hashlib.sha256()
        if isinstance(self.picture, bytes):
            parts: tuple[bytes | memoryview, ...] = (b"PNG", self.picture)
        else:
            parts = (str(self.picture.shape).encode(), np.ascontiguousarray(self.picture).data.cast("B"))
        given = (self.mask, b"") if isinstance(self.mask, bytes) else (b"", str(self.mask).encode())
        by_hand = json.dumps(self.mask_strokes).encode()
        for part in (*parts, *given, by_hand):
            whole.update(len(part).to_bytes(8, "little"))
            whole.update(part)
        return whole.digest()

    def read_lines(self) -> tuple[Picture, MaskOrSource]:
        """Return the picture, and the mask (H, W) or where it comes from.

        Raises:
            InputError: if they cannot be used or do not go together.
        """
        picture = (
            read_png("picture", self.picture) if isinstance(self.picture, bytes) else to_picture(self.picture)
        )
        if not isinstance(self.mask, bytes):
            return picture, self.mask
        return picture, mask_of(read_png("mask", self.mask), picture.shape)

    def read_mask(self, picture: Picture) -> NDArray[np.int8] | None:
        """Return the mask edits (H, W): 1 where a stroke adds, -1 where it cuts; None without strokes.

        Args:
            picture: the drawing.

        Raises:
            InputError: if a stroke cannot be used.
        """
        if not self.mask_strokes:
            return None
        dark = 1 - picture.colour.min(-1)
        inked = (dark if picture.alpha is None else dark * picture.alpha) > _INKED
        return paint_mask(inked, (_read_mask_stroke(*each) for each in enumerate(self.mask_strokes, 1)))

    def edit(self, normals: Floats, mask: NDArray[np.bool_], shape: tuple[int, int]) -> Floats:
        """Apply the form, then the user's areas in order, then the exact pins to a predicted map.

        Args:
            normals: (h, w, 3), unit.
            mask: (h, w), the object.
            shape: (H, W) of the drawing, in whose pixels hints and areas are.

        Raises:
            InputError: if a hint or an area cannot be used.
        """
        free = all(each.get("reach") is None for each in self.hints)
        if not self.areas and self.form is None and free:
            return normals  # held to these pins already
        if self.form is not None:
            normals = give_form(normals, mask, mask.astype(np.float32), read_form("the form", self.form))
        scale = normals.shape[1] / shape[1]
        areas = read_areas(self.areas)
        if any(area.height is not None for area in areas):
            normals = normals.copy()  # lines are carved in place, as there may be thousands
        # Strokes of one structure that follow one another are one: where they cross, it is no steeper.
        for structure, group in groupby(areas, key=lambda area: area.structure):
            if structure is None:
                for area in group:
                    normals = _edit_area(normals, mask, area, scale)
            else:
                cover = np.zeros(mask.shape, np.float32)
                for area in group:
                    np.maximum(cover, _cover(area, mask, scale), out=cover)
                normals = impress(normals, mask, cover, self._tile(structure), structure.scaled(scale))
        if not self.hints:
            return normals
        hints = parse_hints(self.hints, "the request", shape)
        usual = REACH * max(shape)
        reaches = np.array([_number(each.get("reach"), usual, MOST_SIDE) for each in self.hints], np.float32)
        return enforce_pins(
            normals, hints.points * np.float32(scale), hints.normals, reaches * np.float32(scale)
        )

    def _tile(self, structure: "Structure") -> Tile:
        if structure.picture is None:
            return read_tile(take_choice({"kind": structure.kind}, "kind", STRUCTURES))
        if structure.picture not in self.structures:
            raise InputError(f"there is no picture {structure.picture[:40]!r} among the structures.")
        return _tile_of(self.structures[structure.picture])

    def read_hints(self, shape: tuple[int, int]) -> Hints | None:
        """Return the hints for the model, in pixels of the drawing (H, W); None if there are none.

        Hints with their own reach are left out: the reach says how far they work, not the model.

        Raises:
            InputError: if one is invalid.
        """
        hints = parse_hints(self.hints, "the request", shape)
        free = [each.get("reach") is None for each in self.hints]
        return Hints(hints.points[free], hints.normals[free]) if any(free) else None


@dataclass(frozen=True)
class Area:
    """A part of the map whose direction the user sets.

    Args:
        points: (K, 2), x and y in pixels of the drawing: of a closed polygon, or of a stroke.
        normal: (3,), unit.
        size: width of the brush; None for a polygon, which is turned as a whole.
        form: of a polygon; None leaves it as predicted.
        soft: how much of a polygon's depth, or of the brush's radius, it fades over, 0 to 1.
        strength: of the brush, 0 to 1.
        smooths: whether the brush averages what is under it, and gives it no direction.
        height: of a line that stands out, or below 0 is cut in, -1 to 1; None for a brush.
        widths: (K,), of such a line at its points; None is size.
        structure: what the brush gives in place of a direction.
    """

    points: Floats
    normal: Floats
    size: float | None
    form: Form | None
    soft: float
    strength: float
    smooths: bool
    height: float | None
    widths: Floats | None
    structure: "Structure | None"


@dataclass(frozen=True)
class Structure:
    """A structure of the brush.

    Args:
        kind: built in, as `normalgan.inference.structures.KINDS`; "own" is a picture.
        placement: of its tiles, in pixels of the drawing.
        picture: which one of the drawing's structures it is; None is a built-in structure.
    """

    kind: str
    placement: Placement
    picture: str | None

    def scaled(self, scale: float) -> Placement:
        """Return where its tiles lie on a map, of which ``scale`` pixels are one of the drawing."""
        place = self.placement
        return Placement(place.period * scale, place.turn, place.x * scale, place.y * scale, place.flipped)


def _edit_area(normals: Floats, mask: NDArray[np.bool_], area: Area, scale: float) -> Floats:
    """Return a map edited by an area that is no structure; a carved line edits it in place."""
    if area.height is not None and area.size is not None:
        widths = np.full(len(area.points), area.size, np.float32) if area.widths is None else area.widths
        carve(normals, mask, area.points * np.float32(scale), widths * np.float32(scale), area.height)
        return normals
    cover = _cover(area, mask, scale)
    if area.size is None:
        if area.form is not None:
            normals = give_form(normals, mask, cover, area.form)
        return tilt(normals, mask, cover, area.normal)
    if area.smooths:
        return smooth(normals, mask, cover, area.size * scale)
    return brush(normals, cover, area.normal)


def _cover(area: Area, mask: NDArray[np.bool_], scale: float) -> Floats:
    """Return how much an area covers of each pixel of a map (H, W), by its strength."""
    size, points = (mask.shape[0], mask.shape[1]), area.points * np.float32(scale)
    if area.size is not None:
        return np.float32(area.strength) * stroke(size, points, area.size * scale, area.soft)
    cover = polygon(size, points, _SOFT * max(size))
    return feather(cover, area.soft) if area.soft else cover


def read_areas(given: Any) -> list[Area]:
    """Return areas: ``points`` (x, y, x, y, …), ``normal``, and ``size`` if it is a stroke of the brush.

    A polygon may have a ``form``, as `read_form` takes it, and ``soft``, 0 to 1. A stroke may have ``soft``
    and ``strength``, 0 to 1, and ``smooths``, true if it averages the normals under it, or a ``structure``,
    as `read_structure` takes it. With ``height``, -1 to 1, it is a line that is carved, with ``widths`` at
    its points.

    Raises:
        InputError: if one is invalid.
    """
    areas = []
    for number, each in enumerate(given, 1):
        try:
            points = np.array(each["points"], np.float32).reshape(-1, 2)
            normal = np.array(each["normal"], np.float32).reshape(3)
            size = None if each.get("size") is None else float(each["size"])
            length = float(np.linalg.norm(normal))
            fits = len(points) <= MOST_POINTS and bool(np.isfinite(points).all()) and 0.75 < length < 1.25
            fits = fits and bool(normal[2] >= LEAST_Z * length)
            fits = fits and (len(points) >= 3 if size is None else len(points) >= 1 and 0 < size <= MOST_SIDE)
        except (TypeError, ValueError, KeyError, AttributeError):
            fits = False
        if not fits:
            raise InputError(
                f"area {number} is {json.dumps(each)[:60]}; it has points x, y, x, y, … (3 or more, or 1 and "
                f"a size; {MOST_POINTS} at the most) and a normal of length 1 whose z is 0 or more."
            )
        inside = np.clip(points, -MOST_SIDE, 2 * MOST_SIDE)
        given_form = each.get("form")
        form = None if given_form is None else read_form(f"the form of area {number}", given_form)
        usual = _BRUSH_FADES if size is not None else _FADES if form is None else 0
        soft, strength = each.get("soft", usual), each.get("strength", 1)
        for name, share in (("soft", soft), ("strength", strength)):
            if not _is_share(share):
                raise InputError(f"{name} of area {number} is {json.dumps(share)[:40]}; it is 0 to 1.")
        smooths = each.get("smooths", False)
        if not isinstance(smooths, bool):
            raise InputError(f"smooths of area {number} is {json.dumps(smooths)[:40]}; it is true or false.")
        height, widths = each.get("height"), None
        try:
            if height is not None and not _is_share(abs(height)):
                raise ValueError
            if each.get("widths") is not None:
                widths = np.array(each["widths"], np.float32).reshape(len(points))
                if not ((widths > 0) & (widths <= MOST_SIDE)).all():
                    raise ValueError
        except (TypeError, ValueError):
            raise InputError(
                f"area {number} has the height {json.dumps(height)[:40]} and the widths "
                f"{json.dumps(each.get('widths'))[:40]}; a height is -1 to 1, and each width is above 0, one "
                f"for each point."
            ) from None
        given_structure = each.get("structure")
        structure = None
        if given_structure is not None:
            structure = read_structure(f"the structure of area {number}", given_structure)
            if size is None or smooths or height is not None:
                raise InputError(f"area {number} has a structure; only a plain stroke, with a size, has one.")
        direction = normal / np.float32(length)
        areas.append(Area(inside, direction, size, form, soft, strength, smooths, height, widths, structure))
    return areas


def read_structure(name: str, given: Any) -> Structure:
    """Return a structure: ``kind``, ``period``, and maybe ``turn``, ``x``, ``y``, ``flipped``, ``picture``.

    Raises:
        InputError: if it is not one.
    """
    if isinstance(given, dict) and set(given) <= {"kind", "period", "turn", "x", "y", "flipped", "picture"}:
        kind, picture, flipped = given.get("kind"), given.get("picture"), given.get("flipped", False)
        period, turn, x, y = numbers = [given.get(each, 0) for each in ("period", "turn", "x", "y")]
        fits = all(_is_number(each) and abs(each) <= _FARTHEST for each in numbers)
        fits = fits and LEAST_PERIOD <= period <= MOST_PERIOD
        named = isinstance(picture, str) if kind == _OWN else picture is None and kind in STRUCTURES
        if fits and named and isinstance(kind, str) and isinstance(flipped, bool):
            return Structure(kind, Placement(period, turn, x, y, flipped), picture)
    raise InputError(
        f"{name} is {json.dumps(given)[:80]}; its kind is one of {', '.join(STRUCTURES)}, or {_OWN} with the "
        f"name of its picture, its period {LEAST_PERIOD:g} to {MOST_PERIOD}; turn, x and y are numbers."
    )


@lru_cache(maxsize=2 * MOST_STRUCTURES)
def _tile_of(content: bytes) -> Tile:
    """Return the structure in a PNG, white is high."""
    if content[:8] == _PNG and len(content) >= 33:
        sides = struct.unpack(">II", content[16:24])
        if sides != (TILE_SIDE, TILE_SIDE):
            raise InputError(f"a structure is {sides[0]} × {sides[1]} pixels; it has {TILE_SIDE} a side.")
    heights = read_png("structure", content).colour.mean(-1)
    # Its 256 levels would be steps.
    wide = np.pad(heights, 2, mode="wrap")
    return Tile.of(np.asarray(cv2.GaussianBlur(wide, (5, 5), 0)[2:-2, 2:-2], np.float32))


def read_form(name: str, given: Any) -> Form:
    """Return a form: ``kind``, ``bevel`` and ``strength``.

    Raises:
        InputError: if it is not one.
    """
    if isinstance(given, dict) and set(given) == {"kind", "bevel", "strength"}:
        kind, bevel, strength = (given[each] for each in ("kind", "bevel", "strength"))
        if kind in KINDS and _is_share(bevel) and bevel > 0 and _is_share(strength):
            return Form(kind, bevel, strength)
    raise InputError(
        f"{name} is {json.dumps(given)[:80]}; its kind is one of {', '.join(KINDS)}, its bevel above 0 to 1 "
        "and its strength 0 to 1."
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_share(value: Any) -> bool:
    return _is_number(value) and 0 <= value <= 1


def _read_mask_stroke(number: int, given: Any) -> MaskStroke:
    """Return a stroke of the mask brush, or a click that fills an area."""
    try:
        points = np.array(given["points"], np.float32).reshape(-1, 2)
        size, adds, fills = float(given["size"]), given["adds"], given.get("fills", False)
        fits = 1 <= len(points) <= MOST_POINTS and bool(np.isfinite(points).all()) and 0 < size <= MOST_SIDE
    except (TypeError, ValueError, KeyError, AttributeError):
        fits = False
    if not fits or not isinstance(adds, bool) or not isinstance(fills, bool):
        raise InputError(
            f"stroke {number} of the mask is {json.dumps(given)[:60]}; it has points x, y, x, y, … "
            f"({MOST_POINTS} at the most), a size, and adds, true or false; fills is true or false too."
        )
    return MaskStroke(np.clip(points, -MOST_SIDE, 2 * MOST_SIDE), size, adds, fills)


def _number(value: Any, usual: float, most: float) -> float:
    """Return a hint's reach in pixels; None takes the usual one."""
    if value is None:
        return usual
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= most:
        raise InputError(f"a hint's reach is {json.dumps(value)[:40]}; it is 0 to {most:g} pixels.")
    return float(value)


def take_drawing(fields: Fields, picture: NDArray[np.uint8] | None = None) -> DrawingRequest:
    """Return the drawing in a request.

    Args:
        fields: of the request.
        picture: (H, W, 1 or 4), what came as pixels; None takes the PNG from the fields.

    Raises:
        InputError: if a field cannot be used.
    """
    hints = fields.get("hints", [])
    if not isinstance(hints, list):
        raise InputError('the hints are not a list like [{"x": 9, "y": 7, "normal": [0, 0, 1]}].')
    if len(hints) > MOST_HINTS:
        raise InputError(f"there are {len(hints)} hints; a drawing has at most {MOST_HINTS}.")
    areas = fields.get("areas", [])
    if not isinstance(areas, list):
        raise InputError(f"areas must be a list of at most {MOST_AREAS}.")
    carved = sum(isinstance(each, dict) and each.get("height") is not None for each in areas)
    if len(areas) - carved > MOST_AREAS or carved > MOST_CARVED:
        raise InputError(
            f"there are {len(areas) - carved} areas and {carved} carved lines; "
            f"a layer has at most {MOST_AREAS} and {MOST_CARVED}."
        )
    strokes = fields.get("mask_strokes", [])
    if not isinstance(strokes, list) or len(strokes) > MOST_MASK_STROKES:
        raise InputError(f"mask_strokes must be a list of at most {MOST_MASK_STROKES}.")
    structures = fields.get("structures", {})
    if not isinstance(structures, dict) or len(structures) > MOST_STRUCTURES:
        raise InputError(
            f"structures must be an object of at most {MOST_STRUCTURES} pictures by their names."
        )
    source = take_choice(fields, "source", (None, OUTLINE, MODEL))
    return DrawingRequest(
        take_bytes(fields, "picture") if picture is None else picture,
        hints,
        source if fields.get("mask") is None else take_bytes(fields, "mask"),
        areas,
        strokes,
        fields.get("form"),
        {name: take_bytes(structures, name) for name in structures},
    )


def to_picture(pixels: NDArray[np.uint8]) -> Picture:
    """Return grey pixels (H, W, 1) or RGBA pixels (H, W, 4) as a picture."""
    values = np.multiply(pixels, np.float32(1 / 255), dtype=np.float32)
    if pixels.shape[-1] == 1:
        return Picture(np.asarray(cv2.merge([values[..., 0]] * 3), np.float32), None)
    alpha = values[..., 3]
    return Picture(values[..., :3], alpha if pixels[..., 3].min() < 255 else None)


def read_png(name: str, content: bytes) -> Picture:
    """Return a PNG as a picture.

    Raises:
        InputError: if it is not one, or its size is out of range; that is checked before decoding.
    """
    if content[:8] != _PNG or content[12:16] != b"IHDR" or len(content) < 33:
        raise InputError(f"the {name} is not a PNG.")
    width, height = struct.unpack(">II", content[16:24])
    check_sides(name, height, width)
    picture = read_picture(Path(f"the {name}"), content)
    check_sides(name, *picture.shape)  # a damaged file may have a second head
    return picture


def check_sides(name: str, height: int, width: int) -> None:
    """Raise `InputError` if the studio does not take a picture of this size."""
    if not LEAST_SIDE <= min(height, width) <= max(height, width) <= MOST_SIDE:
        raise InputError(
            f"the {name} is {width} × {height} pixels; "
            f"in the studio it has {LEAST_SIDE} to {MOST_SIDE} a side."
        )
