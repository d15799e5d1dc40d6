"""Planes: receive a drawing's pixels as raw bytes, of which the page sends only the changed part."""

import struct
from collections import OrderedDict
from typing import Final

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.studio.drawings.schemas import DrawingFields, Plane
from normalgan.studio.server.refusals import BehindError

Pixels = NDArray[np.uint8]

CONTENT_TYPE: Final = "application/x-normalgan-drawing"
"""Type of a body made up of the length of a JSON text (4 bytes, little-endian), the text, and pixels."""
_MOST = 256
"""Maximum number of layers whose pixels are kept."""
_BYTES = 2**28
"""Maximum number of bytes kept for all layers, enough for the largest possible drawing."""


def split_body(body: bytes) -> tuple[bytes, memoryview]:
    """Return the JSON text of a body and the bytes after it.

    Raises:
        InputError: if the body is truncated.
    """
    length: int = struct.unpack_from("<I", body)[0] if len(body) >= 4 else 0
    if len(body) < 4 + length or not length:
        raise InputError("the body is cut off; send a length, a JSON text of that length, and pixels.")
    return body[4 : 4 + length], memoryview(body)[4 + length :]


class KeptPlanes:
    """Keeps the latest pixels of each layer and tab, to which later requests send changes. Not thread-safe.

    Args:
        most: maximum number of layers to keep.
    """

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._kept: OrderedDict[str, tuple[int, Pixels]] = OrderedDict()

    def take(
        self, tab: str, drawing: DrawingFields, pixels: memoryview, number: int, keep: bool = True
    ) -> Pixels:
        """Return the full pixels of a request; callers must not modify them.

        Args:
            tab: identifier of the tab and layer.
            drawing: fields of the drawing. ``planes`` gives the box of the changed part, ``base`` the number
                of the request that is changed.
            pixels: bytes of the box.
            number: number of the request.
            keep: whether later requests may send changes to these pixels.

        Returns:
            Pixels (H, W, 1), grey, or (H, W, 4), with opacity.

        Raises:
            BehindError: if the base is not kept; the page must then send all pixels.
            InputError: if the bytes do not match the fields.
        """
        if not drawing.planes:
            raise InputError('planes is missing; it is a list like [{"name": "ink", "width": 64, …}].')
        before = None
        if drawing.base is not None:
            kept, before = self._kept.get(tab, (None, None))
            if kept != drawing.base:
                raise BehindError("the server does not have the drawing that this changes; send all of it.")
        ink = _changed(before, drawing.planes[0], pixels)
        if keep:
            self._kept[tab] = number, ink
            self._kept.move_to_end(tab)
            while len(self._kept) > 1 and (len(self._kept) > self._most or self._size() > _BYTES):
                self._kept.popitem(last=False)
        return ink

    def _size(self) -> int:
        return sum(ink.nbytes for _, ink in self._kept.values())


def _changed(before: Pixels | None, plane: Plane, pixels: memoryview) -> Pixels:
    """Return the pixels with a box replaced."""
    left, top, right, bottom = plane.box
    width, height, channels = plane.width, plane.height, plane.channels
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
