"""Planes: a drawing's pixels as raw bytes; the page sends only the changed part."""

import struct
from collections import OrderedDict
from typing import Final

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.studio.drawings.schemas import DrawingFields, Plane
from normalgan.studio.server.refusals import BehindError

__all__ = ["CONTENT_TYPE", "KeptPlanes", "Pixels", "split_body"]

Pixels = NDArray[np.uint8]

CONTENT_TYPE: Final = "application/x-normalgan-drawing"
"""Of a body that is the length of a JSON text (4 bytes, little-endian), the text, and the pixels' bytes."""
_MOST = 256
"""Layers whose pixels are kept."""
_BYTES = 2**28
"""That all of them may take together: as much as the most layers of the largest drawing."""


def split_body(body: bytes) -> tuple[bytes, memoryview]:
    """Return the JSON text of a body, and the bytes after it.

    Raises:
        InputError: if there is none.
    """
    length: int = struct.unpack_from("<I", body)[0] if len(body) >= 4 else 0
    if len(body) < 4 + length or not length:
        raise InputError("the body is cut off; it is a length, a JSON text of that length, and pixels.")
    return body[4 : 4 + length], memoryview(body)[4 + length :]


class KeptPlanes:
    """The last pixels of each layer and tab, to which a request sends changes. Not thread-safe.

    Args:
        most: layers to keep.
        largest: bytes to keep.
    """

    def __init__(self, most: int = _MOST, largest: int = _BYTES) -> None:
        self._most, self._largest = most, largest
        self._kept: OrderedDict[str, tuple[int, Pixels]] = OrderedDict()

    def take(
        self, tab: str, drawing: DrawingFields, pixels: memoryview, number: int, keep: bool = True
    ) -> Pixels:
        """Return the pixels of a request, read-only.

        Args:
            tab: who asks, and for which layer.
            drawing: its ``planes`` say what part of it the bytes are, its ``base`` what they change.
            pixels: of the planes' box.
            number: of the request.
            keep: whether this may be a base itself.

        Returns:
            (H, W, 1), grey, or (H, W, 4), with opacity.

        Raises:
            BehindError: if the base is not what was kept; the page must send all then.
            InputError: if they do not go together.
        """
        if not drawing.planes:
            raise InputError('planes is missing; it is a list like [{"name": "ink", "width": 64, …}].')
        before = None
        if drawing.base is not None:
            kept, before = self._kept.get(tab, (None, None))
            if kept != drawing.base:
                raise BehindError(
                    "the server does not have the drawing that this is a change of; send it all."
                )
        ink = _changed(before, drawing.planes[0], pixels)
        if keep:
            self._kept[tab] = number, ink
            self._kept.move_to_end(tab)
            while len(self._kept) > 1 and (len(self._kept) > self._most or self._size() > self._largest):
                self._kept.popitem(last=False)
        return ink

    def _size(self) -> int:
        return sum(ink.nbytes for _, ink in self._kept.values())


def _changed(before: Pixels | None, plane: Plane, pixels: memoryview) -> Pixels:
    """Return the pixels with those of a box replaced."""
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
