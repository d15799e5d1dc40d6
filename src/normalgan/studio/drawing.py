"""Drawing: what a request asks to be painted: a picture, hints, and where the object is."""

import hashlib
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.painting.hint_files import Hints, parse_hints
from normalgan.painting.jobs import MODEL, OUTLINE
from normalgan.painting.masks import mask_of
from normalgan.painting.picture import Picture, read_picture
from normalgan.studio.fields import Fields, take_bytes, take_choice

LEAST_SIDE, MOST_SIDE = 16, 2048
"""Least and greatest side of a drawing in pixels."""
MOST_HINTS = 200
_PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Drawing:
    """A drawing as it came, not decoded yet.

    Args:
        picture: PNG, or pixels (H, W, 1), grey, or (H, W, 4), with opacity.
        hints: list of x, y and normal.
        mask: PNG, white on the object; None if there is none.
        source: where the mask comes from if there is none, as for `normalgan.painting.preparation.prepare`.
    """

    picture: bytes | NDArray[np.uint8]
    hints: Any
    mask: bytes | None
    source: str | None

    def digest(self) -> bytes:
        """Return what is the same for the same drawings and for no others."""
        return hashlib.sha256(self.lines_digest() + json.dumps(self.hints).encode()).digest()

    def lines_digest(self) -> bytes:
        """Return what is the same for drawings that differ in their hints alone, and for no others."""
        whole = hashlib.sha256()
        if isinstance(self.picture, bytes):
            parts: tuple[bytes | memoryview, ...] = (b"PNG", self.picture)
        else:
            parts = (str(self.picture.shape).encode(), np.ascontiguousarray(self.picture).data.cast("B"))
        for part in (*parts, self.mask or b"", str(self.source).encode()):
            whole.update(len(part).to_bytes(8, "little"))
            whole.update(part)
        return whole.digest()

    def read_lines(self) -> tuple[Picture, NDArray[np.bool_] | None]:
        """Return the picture and the mask (H, W).

        Raises:
            InputError: if they cannot be used or do not go together.
        """
        picture = (
            read_png("picture", self.picture) if isinstance(self.picture, bytes) else to_picture(self.picture)
        )
        if self.mask is None:
            return picture, None
        return picture, mask_of(read_png("mask", self.mask), picture.shape)

    def read_hints(self, shape: tuple[int, int]) -> Hints | None:
        """Return the hints of the drawing, which has (H, W) pixels; None if there are none.

        Raises:
            InputError: if one cannot be used.
        """
        hints = parse_hints(self.hints, "the request", shape)
        return hints if len(hints.points) else None


def take_drawing(fields: Fields, picture: NDArray[np.uint8] | None = None) -> Drawing:
    """Return the drawing in a request.

    Args:
        fields: of the request.
        picture: (H, W, 1 or 4), what came as pixels; None takes the PNG from the fields.

    Raises:
        InputError: if a field cannot be used.
    """
    hints = fields.get("hints", [])
    if not isinstance(hints, list):
        raise InputError('the hints are no list; they are like [{"x": 9, "y": 7, "normal": [0, 0, 1]}].')
    if len(hints) > MOST_HINTS:
        raise InputError(f"there are {len(hints)} hints; a drawing has at most {MOST_HINTS}.")
    return Drawing(
        take_bytes(fields, "picture") if picture is None else picture,
        hints,
        None if fields.get("mask") is None else take_bytes(fields, "mask"),
        take_choice(fields, "source", (None, OUTLINE, MODEL)),
    )


def to_picture(pixels: NDArray[np.uint8]) -> Picture:
    """Return pixels (H, W, 1), grey, or (H, W, 4), with opacity, as a picture."""
    values = np.multiply(pixels, np.float32(1 / 255), dtype=np.float32)
    if pixels.shape[-1] == 1:
        return Picture(np.asarray(cv2.merge([values[..., 0]] * 3), np.float32), None)
    alpha = values[..., 3]
    return Picture(values[..., :3], alpha if pixels[..., 3].min() < 255 else None)


def read_png(name: str, content: bytes) -> Picture:
    """Return a PNG as a picture.

    Raises:
        InputError: if it is none, or too large or small, which is seen before it is decoded.
    """
    if content[:8] != _PNG or content[12:16] != b"IHDR" or len(content) < 33:
        raise InputError(f"the {name} is no PNG.")
    width, height = struct.unpack(">II", content[16:24])
    check_sides(name, height, width)
    picture = read_picture(Path(f"the {name}"), content)
    check_sides(name, *picture.shape)  # a damaged file may have a second head
    return picture


def check_sides(name: str, height: int, width: int) -> None:
    """Raise `InputError` if a picture of this size is not one for the studio."""
    if not LEAST_SIDE <= min(height, width) <= max(height, width) <= MOST_SIDE:
        raise InputError(
            f"the {name} is {width} × {height} pixels; "
            f"in the studio it has {LEAST_SIDE} to {MOST_SIDE} a side."
        )
