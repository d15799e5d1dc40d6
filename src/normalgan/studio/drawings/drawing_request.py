"""DrawingRequest: the picture, mask, hints and edits of a request."""

import hashlib
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import groupby
from pathlib import Path
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.edits import (
    REACH,
    SOFT,
    brush,
    carve,
    enforce_pins,
    paint_mask,
    polygon,
    smooth,
    stroke,
    tilt,
)
from normalgan.inference.forms import feather, give_form
from normalgan.inference.mask.mask_files import MaskOrSource, MaskSource, mask_of
from normalgan.inference.reading.hint_files import Hints, check_hints
from normalgan.inference.reading.picture import Picture, read_picture
from normalgan.inference.regions import INKED
from normalgan.inference.structures import Tile, impress, read_tile
from normalgan.inference.unrolling import unroll
from normalgan.studio.drawings.limits import LEAST_SIDE, MOST_SIDE, MOST_STRUCTURES, TILE_SIDE
from normalgan.studio.drawings.schemas import Area, DrawingFields, HintFields, Structure

_PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class DrawingRequest:
    """The drawing of a request, not yet decoded.

    Args:
        picture: a PNG, or pixels (H, W, 1), grey, or (H, W, 4), with opacity.
        mask: a PNG, white on the object; or a mask source, as in `normalgan.inference.preparation.prepare`.
        fields: the user's hints and edits; the picture and the mask in them are not read.
    """

    picture: bytes | NDArray[np.uint8]
    mask: bytes | MaskSource | None = None
    fields: DrawingFields = field(default_factory=DrawingFields)

    @classmethod
    def of(
        cls, fields: DrawingFields, pixels: NDArray[np.uint8] | None = None, source: MaskSource | None = None
    ) -> Self:
        """Return the drawing of a request.

        Args:
            fields: fields of the drawing.
            pixels: (H, W, 1 or 4), the pixels that followed the fields; None uses the PNG in the fields.
            source: mask source if no mask is given; None uses the source in the fields.

        Raises:
            InputError: if there is no picture.
        """
        picture = fields.picture if pixels is None else pixels
        if picture is None:
            raise InputError("picture is missing.")
        return cls(picture, (source or fields.source) if fields.mask is None else fields.mask, fields)

    @property
    def shape(self) -> tuple[int, ...] | None:
        """(H, W) if the picture came as pixels, otherwise None."""
        return None if isinstance(self.picture, bytes) else self.picture.shape[:2]

    @property
    def drawn(self) -> bool:
        """Whether the drawing consists of strokes only, without an imported picture."""
        return not isinstance(self.picture, bytes) and self.picture.shape[-1] == 1

    def digest(self) -> bytes:
        """Return a hash of the drawing."""
        by_hand = to_json([self.fields.hints, self.fields.areas, self.fields.form])
        own = b"".join(name.encode() + content for name, content in self.fields.structures.items())
        return hashlib.sha256(self.lines_digest() + hashlib.sha256(by_hand).digest() + own).digest()

    def lines_digest(self) -> bytes:
        """Return a hash of the drawing without its hints, areas, form and structures."""
        given = (self.mask, b"") if isinstance(self.mask, bytes) else (b"", str(self.mask).encode())
        return _hash(self.picture_digest, *given, to_json(self.fields.mask_strokes))

    @cached_property
    def picture_digest(self) -> bytes:
        """A hash of the picture."""
        if isinstance(self.picture, bytes):
            return _hash(b"PNG", self.picture)
        return _hash(str(self.picture.shape).encode(), np.ascontiguousarray(self.picture).data.cast("B"))

    def read_lines(self) -> tuple[Picture, MaskOrSource]:
        """Return the picture, and the mask (H, W) or mask source.

        Raises:
            InputError: if the picture or the mask is invalid, or their sizes differ.
        """
        picture = (
            read_png("picture", self.picture) if isinstance(self.picture, bytes) else to_picture(self.picture)
        )
        if not isinstance(self.mask, bytes):
            return picture, self.mask
        return picture, mask_of(read_png("mask", self.mask), picture.shape)

    def read_mask(self, picture: Picture, reading: Reading | None) -> NDArray[np.int8] | None:
        """Return the mask edits (H, W): 1 where a stroke adds, -1 where it cuts; None without strokes.

        Args:
            picture: the drawing.
            reading: the reader's output, which separates lines from dark paper; None for strokes.
        """
        if not self.fields.mask_strokes:
            return None
        ink = picture.darkness() if reading is None else reading.ink_at(picture)
        return paint_mask(ink > INKED, (each.stroke for each in self.fields.mask_strokes))

    def edit(self, normals: Floats, mask: BoolMask, shape: tuple[int, int]) -> Floats:
        """Return a predicted map with the form, then the areas in order, then the exact pins applied.

        Args:
            normals: (h, w, 3), unit normals.
            mask: (h, w), the object.
            shape: (H, W) of the drawing; hints and areas are in pixels of it.

        Raises:
            InputError: if a hint or an area is invalid.
        """
        given = self.fields
        free = all(each.reach is None for each in given.hints)
        if not given.areas and given.form is None and free:
            return normals  # the prediction has these pins already
        if given.form is not None:
            normals = give_form(normals, mask, mask.astype(np.float32), given.form)
        scale = normals.shape[1] / shape[1]
        if any(area.carves for area in given.areas):
            normals = normals.copy()  # lines are carved in place, because there may be thousands
        unrolled: Floats | None = None
        # Consecutive strokes of the same structure are merged, so that they do not add up where they cross.
        for structure, group in groupby(given.areas, key=lambda area: area.structure):
            if structure is None:
                for area in group:
                    normals = _edit_area(normals, mask, area, scale)
            else:
                cover = np.zeros(mask.shape, np.float32)
                for area in group:
                    np.maximum(cover, _cover(area, mask, scale), out=cover)
                if unrolled is None:  # once, so that a structure does not follow the bumps of another
                    unrolled = unroll(normals, mask)
                placement = structure.scaled(scale)
                normals = impress(normals, mask, cover, self._tile(structure), placement, unrolled)
        if not given.hints:
            return normals
        hints = to_hints(given.hints, shape)
        usual = REACH * max(shape)
        reaches = np.array([usual if each.reach is None else each.reach for each in given.hints], np.float32)
        return enforce_pins(
            normals, hints.points * np.float32(scale), hints.normals, reaches * np.float32(scale)
        )

    def _tile(self, structure: Structure) -> Tile:
        if structure.picture is not None:
            return _tile_of(self.fields.structures[structure.picture])
        assert structure.kind != "own"  # "own" implies a picture
        return read_tile(structure.kind)

    def read_hints(self, shape: tuple[int, int]) -> Hints | None:
        """Return the hints for the model in pixels of the drawing (H, W); None if there are none.

        Hints with a reach are left out, because the reach determines their effect instead of the model.

        Raises:
            InputError: if a hint is invalid.
        """
        checked = to_hints(self.fields.hints, shape)
        free = [each.reach is None for each in self.fields.hints]
        return Hints(checked.points[free], checked.normals[free]) if any(free) else None


def _hash(*parts: bytes | memoryview) -> bytes:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(len(part).to_bytes(8, "little"))
        whole.update(part)
    return whole.digest()


def to_hints(hints: Sequence[HintFields], shape: tuple[int, int]) -> Hints:
    """Return the hints of a request in pixels of the drawing (H, W).

    Raises:
        InputError: if a hint is invalid.
    """
    return check_hints([(each.x, each.y, each.normal) for each in hints], "the request", shape)


def _edit_area(normals: Floats, mask: BoolMask, area: Area, scale: float) -> Floats:
    """Return a map edited by an area without a structure; carved lines edit the map in place."""
    if area.height is not None and area.size is not None:
        widths = np.array(area.widths or [area.size] * (len(area.points) // 2), np.float32)
        carve(normals, mask, area.line(scale), widths * np.float32(scale), area.height)
        return normals
    cover = _cover(area, mask, scale)
    if area.size is None:
        if area.form is not None:
            normals = give_form(normals, mask, cover, area.form)
        return tilt(normals, mask, cover, area.direction)
    if area.smooths:
        return smooth(normals, mask, cover, area.size * scale)
    return brush(normals, cover, area.direction)


def _cover(area: Area, mask: BoolMask, scale: float) -> Floats:
    """Return the coverage of each pixel (H, W) of a map by an area, times the area's strength."""
    size, points = (mask.shape[0], mask.shape[1]), area.line(scale)
    if area.size is not None:
        return np.float32(area.strength) * stroke(size, points, area.size * scale, area.fade)
    cover = polygon(size, points, SOFT * max(size))
    return feather(cover, area.fade) if area.fade else cover


@lru_cache(maxsize=2 * MOST_STRUCTURES)
def _tile_of(content: bytes) -> Tile:
    """Return the structure of a PNG in which white is high."""
    sides = _png_sides(content)
    if sides is not None and sides != (TILE_SIDE, TILE_SIDE):
        raise InputError(f"a structure is {sides[0]} × {sides[1]} pixels; it must have {TILE_SIDE} a side.")
    heights = read_png("structure", content).colour.mean(-1)
    # Smoothed, because 256 levels would give visible steps.
    wide = np.pad(heights, 2, mode="wrap")
    return Tile.of(np.asarray(cv2.GaussianBlur(wide, (5, 5), 0)[2:-2, 2:-2], np.float32))


def to_picture(pixels: NDArray[np.uint8]) -> Picture:
    """Return grey pixels (H, W, 1) or RGBA pixels (H, W, 4) as a picture."""
    values = np.multiply(pixels, np.float32(1 / 255), dtype=np.float32)
    if pixels.shape[-1] == 1:
        return Picture(np.asarray(cv2.merge([values[..., 0]] * 3), np.float32), None)
    if pixels[..., 3].min() < 255:
        return Picture(values[..., :3], values[..., 3])
    # Sums over strided colours differ in the last bit from those over the colours of a file without alpha.
    return Picture(np.ascontiguousarray(values[..., :3]), None)


def read_png(name: str, content: bytes) -> Picture:
    """Return a PNG as a picture.

    Raises:
        InputError: if it is not a PNG, or its size, which is checked before decoding, is out of range.
    """
    sides = _png_sides(content)
    if sides is None:
        raise InputError(f"the {name} is not a PNG.")
    width, height = sides
    check_sides(name, height, width)
    picture = read_picture(Path(f"the {name}"), content)
    check_sides(name, *picture.shape)  # a damaged file may have a second header
    return picture


def _png_sides(content: bytes) -> tuple[int, int] | None:
    """Return the width and height in the header of a PNG; None if it is not a PNG."""
    if content[:8] != _PNG or content[12:16] != b"IHDR" or len(content) < 33:
        return None
    width, height = struct.unpack(">II", content[16:24])
    return width, height


def check_sides(name: str, height: int, width: int) -> None:
    """Raise `InputError` if a picture of this size is not accepted."""
    if not LEAST_SIDE <= min(height, width) <= max(height, width) <= MOST_SIDE:
        raise InputError(
            f"the {name} is {width} × {height} pixels; the studio accepts {LEAST_SIDE} to {MOST_SIDE} a side."
        )
