"""Planes: a drawing's pixels as raw bytes; the page sends only the changed part."""

import json
import struct
from collections import OrderedDict
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.studio.drawing_request import check_sides
from normalgan.studio.fields import Fields, parse_fields, take_choice, take_integer
from normalgan.studio.refusals import BehindError

__all__ = ["CHANNELS", "CONTENT_TYPE", "KeptPlanes", "Pixels", "Planes", "split_body"]

Pixels = NDArray[np.uint8]
Planes = Mapping[str, Pixels]

CONTENT_TYPE: Final = "application/x-normalgan-drawing"
"""Of a body that is the length of a JSON text (4 bytes, little-endian), the text, and the planes' bytes."""
CHANNELS: Final = {"ink": (1, 4)}
"""How many channels each plane may have: ink is grey, or red, green, blue and opacity."""
_LARGEST = 2**53
_MOST = 256
"""Layers whose planes are kept."""
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
        self._kept: OrderedDict[str, tuple[int, Planes]] = OrderedDict()

    def take(self, tab: str, fields: Fields, pixels: memoryview) -> Planes:
        """Return the planes of a request by name, (H, W, C), read-only.

        Args:
            tab: who asks, and for which layer.
            fields: ``planes``, a list of ``name``, ``width``, ``height``, ``channels`` and the ``box`` (left,
                top, right, bottom) that the bytes are of; ``number``; ``base``, the number of the request
                whose planes these are changes of, null for none; ``keep``, whether this may be a base itself.
            pixels: of the boxes, one plane after the other.

        Raises:
            BehindError: if the base is not what was kept; all is to be sent then.
            InputError: if they do not go together.
        """
        listed = fields.get("planes")
        if not isinstance(listed, list) or len(listed) > len(CHANNELS):
            raise InputError('planes are a list like [{"name": "ink", "width": 64, …}].')
        planes: dict[str, Pixels] = {}
        if fields.get("base") is not None:
            base = take_integer(fields, "base", 0, _LARGEST)
            number, before = self._kept.get(tab, (None, MappingProxyType({})))
            if number != base:
                raise BehindError(
                    "the server does not have the drawing that this is a change of; send it all."
                )
            planes.update(before)
        offset = 0
        for each in listed:
            offset += _change(planes, each, pixels[offset:])
        if offset != len(pixels):
            raise InputError(f"there are {len(pixels)} bytes of pixels; the planes' boxes have {offset}.")
        if "ink" not in planes:
            raise InputError("there is no plane ink; it is the drawing.")
        if len({plane.shape[:2] for plane in planes.values()}) > 1:
            raise InputError("the planes are of different sizes; they are to have the drawing's.")
        if take_choice(fields, "keep", (False, True), True):
            self._kept[tab] = take_integer(fields, "number", 0, _LARGEST), MappingProxyType(planes)
            self._kept.move_to_end(tab)
            while len(self._kept) > 1 and (len(self._kept) > self._most or self._size() > self._largest):
                self._kept.popitem(last=False)
        return planes

    def _size(self) -> int:
        return sum(plane.nbytes for _, planes in self._kept.values() for plane in planes.values())


def _change(planes: dict[str, Pixels], given: object, pixels: memoryview) -> int:
    """Replace a box of pixels in its plane, and return its number of bytes."""
    if not isinstance(given, dict) or given.get("name") not in CHANNELS:
        raise InputError(f"a plane is {json.dumps(given)[:60]}; it has a name among {', '.join(CHANNELS)}.")
    name: str = given["name"]
    width, height = (take_integer(given, side, 1, 2**20) for side in ("width", "height"))
    check_sides("drawing", height, width)
    channels = take_integer(given, "channels", 1, 4)
    if channels not in CHANNELS[name]:
        raise InputError(
            f"the plane {name} has {channels} channels; it has {' or '.join(map(str, CHANNELS[name]))}."
        )
    match given.get("box"):
        case [int(left), int(top), int(right), int(bottom)] if (
            0 <= left <= right <= width and 0 <= top <= bottom <= height
        ):
            pass
        case other:
            raise InputError(
                f"the box of {name} is {json.dumps(other)[:60]}; it is left, top, right, bottom."
            )
    shape = (height, width, channels)
    size = (bottom - top) * (right - left) * channels
    if size > len(pixels):
        raise InputError(f"the plane {name} is cut off: {size} bytes belong to its box.")
    part = np.frombuffer(pixels[:size], np.uint8).reshape(bottom - top, right - left, channels)
    if part.shape == shape:
        planes[name] = part.copy()
        return size
    before = planes.get(name)
    if before is None or before.shape != shape:
        raise BehindError(f"the server has no {name} of {width} × {height} pixels; send all of it.")
    if size:
        planes[name] = before.copy()
        planes[name][top:bottom, left:right] = part
    return size
