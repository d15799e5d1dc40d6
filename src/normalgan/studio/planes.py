"""Planes: a drawing's pixels as raw bytes; the page sends only the changed part."""

import json
import struct
from collections import OrderedDict
from typing import Final

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.studio.drawing_request import check_sides
from normalgan.studio.fields import LARGEST, Fields, parse_fields, take_choice, take_integer
from normalgan.studio.refusals import BehindError

__all__ = ["CONTENT_TYPE", "KeptPlanes", "Pixels", "split_body"]

Pixels = NDArray[np.uint8]

CONTENT_TYPE: Final = "application/x-normalgan-drawing"
"""Of a body that is the length of a JSON text (4 bytes, little-endian), the text, and the pixels' bytes."""
_CHANNELS = (1, 4)
"""Grey, or red, green, blue and opacity."""
_MOST = 256
"""Layers whose pixels are kept."""
_BYTES = 2**28
"""That all of them may take together: as much as the most layers of the largest drawing."""


def split_body(body: bytes) -> tuple[Fields, memoryview]:
    """Return the JSON object of a body, and the bytes after it.

    Raises:
        InputError: if there is none.
    """
    length: int = struct.unpack_from("<I", body)[0] if len(body) >= 4 else 0
    if len(body) < 4 + length or not length:
        raise InputError("the body is cut off; it is a length, a JSON text of that length, and pixels.")
    return parse_fields(body[4 : 4 + length]), memoryview(body)[4 + length :]


class KeptPlanes:
    """The last pixels of each layer and tab, to which a request sends changes. Not thread-safe.

    Args:
        most: layers to keep.
        largest: bytes to keep.
    """

    def __init__(self, most: int = _MOST, largest: int = _BYTES) -> None:
        self._most, self._largest = most, largest
        self._kept: OrderedDict[str, tuple[int, Pixels]] = OrderedDict()

    def take(self, tab: str, fields: Fields, pixels: memoryview) -> Pixels:
        """Return the pixels of a request, (H, W, 1 or 4), read-only.

        Args:
            tab: who asks, and for which layer.
            fields: ``planes``, a list of one with its ``name``, ink, its ``width``, ``height``, ``channels``
                and the ``box`` (left, top, right, bottom) that the bytes are of; ``number``; ``base``, the
                number of the request whose pixels these are changes of, null for none; ``keep``, whether
                this may be a base itself.
            pixels: of the box.

        Raises:
            BehindError: if the base is not what was kept; the page must send all then.
            InputError: if they do not go together.
        """
        match fields.get("planes"):
            case [{"name": "ink"} as plane]:
                pass
            case _:
                raise InputError('planes must be a list like [{"name": "ink", "width": 64, …}].')
        before = None
        if fields.get("base") is not None:
            base = take_integer(fields, "base", 0, LARGEST)
            number, before = self._kept.get(tab, (None, None))
            if number != base:
                raise BehindError(
                    "the server does not have the drawing that this is a change of; send it all."
                )
        ink = _changed(before, plane, pixels)
        if take_choice(fields, "keep", (False, True), True):
            self._kept[tab] = take_integer(fields, "number", 0, LARGEST), ink
            self._kept.move_to_end(tab)
            while len(self._kept) > 1 and (len(self._kept) > self._most or self._size() > self._largest):
                self._kept.popitem(last=False)
        return ink

    def _size(self) -> int:
        return sum(ink.nbytes for _, ink in self._kept.values())


def _changed(before: Pixels | None, plane: Fields, pixels: memoryview) -> Pixels:
    """Return the pixels with those of a box replaced."""
    width, height = (take_integer(plane, side, 1, 2**20) for side in ("width", "height"))
    check_sides("drawing", height, width)
    channels = take_integer(plane, "channels", 1, 4)
    if channels not in _CHANNELS:
        raise InputError(f"the plane ink has {channels} channels; it has {' or '.join(map(str, _CHANNELS))}.")
    match plane.get("box"):
        case [int(left), int(top), int(right), int(bottom)] if (
            0 <= left <= right <= width and 0 <= top <= bottom <= height
        ):
            pass
        case other:
            raise InputError(f"the box of ink is {json.dumps(other)[:60]}; it is left, top, right, bottom.")
    shape = (height, width, channels)
    size = (bottom - top) * (right - left) * channels
    if size != len(pixels):
        raise InputError(f"there are {len(pixels)} bytes of pixels; the box of ink has {size}.")
    part = np.frombuffer(pixels, np.uint8).reshape(bottom - top, right - left, channels)
    if part.shape == shape:
        return part.copy()
    if before is None or before.shape != shape:
        raise BehindError(f"the server has no ink of {width} × {height} pixels; send all of it.")
    if not size:
        return before
    ink = before.copy()
    ink[top:bottom, left:right] = part
    return ink
