"""Drawing: what a request asks to be painted: a picture, hints, and where the object is."""

import hashlib
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.painting.hint_files import Hints, parse_hints
from normalgan.painting.jobs import MODEL, OUTLINE
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
        picture: PNG.
        hints: list of x, y and normal.
        mask: PNG, white on the object; None if there is none.
        source: where the mask comes from if there is none, as for `normalgan.painting.preparation.prepare`.
    """

    picture: bytes
    hints: Any
    mask: bytes | None
    source: str | None

    def digest(self) -> bytes:
        """Return what is the same for the same drawings and for no others."""
        parts = (self.picture, json.dumps(self.hints).encode(), self.mask or b"", str(self.source).encode())
        whole = hashlib.sha256()
        for part in parts:
            whole.update(len(part).to_bytes(8, "little") + part)
        return whole.digest()

    def read(self) -> tuple[Picture, Hints | None, NDArray[np.bool_] | None]:
        """Return the picture, the hints and the mask (H, W).

        Raises:
            InputError: if they cannot be used or do not go together.
        """
        picture = read_png("picture", self.picture)
        mask = None
        if self.mask is not None:
            given = read_png("mask", self.mask)
            if given.shape != picture.shape:
                raise InputError(
                    f"the mask is {given.shape[1]} × {given.shape[0]} pixels, but the drawing "
                    f"{picture.shape[1]} × {picture.shape[0]}."
                )
            opacity = 1 if given.alpha is None else given.alpha
            mask = given.colour.mean(-1) * opacity > 0.5
            if not mask.any():
                raise InputError("the mask is empty; paint the object white.")
        hints = parse_hints(self.hints, "the request", picture.shape)
        return picture, hints if len(hints.points) else None, mask


def take_drawing(fields: Fields) -> Drawing:
    """Return the drawing in a request.

    Raises:
        InputError: if a field cannot be used.
    """
    hints = fields.get("hints", [])
    if not isinstance(hints, list):
        raise InputError('the hints are no list; they are like [{"x": 9, "y": 7, "normal": [0, 0, 1]}].')
    if len(hints) > MOST_HINTS:
        raise InputError(f"there are {len(hints)} hints; a drawing has at most {MOST_HINTS}.")
    return Drawing(
        take_bytes(fields, "picture"),
        hints,
        None if fields.get("mask") is None else take_bytes(fields, "mask"),
        take_choice(fields, "source", (None, OUTLINE, MODEL)),
    )


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
