"""Picture: the colours and opacity of a drawing."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.decoding import Decoded, FileNotes
from normalgan.inference.reading.drawings import SVG_SIDE, read_pixels, to_unit

MOST_WORKED = 2048
"""Maximum longer side in pixels of the working size; maps of larger drawings are enlarged."""
Resize = Callable[[Floats, tuple[int, int]], Floats]
"""Resizes a picture (H, W) or (H, W, C) to a new (H, W)."""


@dataclass(frozen=True)
class Picture:
    """A drawing's colours and opacity.

    Args:
        colour: (h, w, 3) in [0, 1], red, green and blue, not premultiplied.
        alpha: (h, w) in [0, 1], opacity; None if every pixel is opaque and it was not cut out.
        full: (H, W) of the file if it has more pixels; otherwise None.
        notes: differences between the picture and how the file looks in the program that wrote it.
        cut_out: whether it was cut out of a sheet with transparent parts, so that an opaque rectangle is a
            drawing, such as a crate, and not its paper.
    """

    colour: Floats
    alpha: Floats | None
    full: tuple[int, int] | None = None
    notes: FileNotes = field(default_factory=FileNotes)
    cut_out: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W) of the file; hints and masks are in these pixels."""
        return self.full or self.size

    @property
    def size(self) -> tuple[int, int]:
        """(h, w) of the pixels in memory."""
        return self.colour.shape[0], self.colour.shape[1]

    def darkness(self) -> Floats:
        """Return how dark each pixel (h, w) is: 1 minus its smallest colour."""
        red, green, blue = np.moveaxis(self.colour, -1, 0)
        # NumPy takes many times as long to reduce the last axis.
        return np.asarray(1 - np.minimum(np.minimum(red, green), blue), np.float32)

    def resized(self, shape: tuple[int, int], by: "Resize | None" = None) -> "Picture":
        """Return the picture resized to (H, W), by `resize` or another function."""
        if shape == self.size:
            return self
        by = by or resize
        if self.alpha is None:
            return Picture(np.clip(by(self.colour, shape), 0, 1), None)
        # Colours of transparent pixels must not bleed into visible ones.
        seen = by(np.dstack([self.colour * self.alpha[..., None], self.alpha]), shape)
        colour = seen[..., :3] / np.maximum(seen[..., 3:], 1e-4)
        return Picture(np.clip(colour, 0, 1), np.clip(seen[..., 3], 0, 1), cut_out=self.cut_out)


def resize(picture: Floats, shape: tuple[int, int]) -> Floats:
    """Return a picture (H, W) or (H, W, C) resized to a new (H, W), by area averaging or interpolation."""
    shrinks = shape[0] < picture.shape[0]
    method = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, shape[::-1], interpolation=method), np.float32)


def fitted(shape: tuple[int, int], longest: int | None) -> tuple[int, int]:
    """Return (H, W) scaled so that the longer side is ``longest``; unchanged if that is None.

    >>> fitted((300, 600), 1024)
    (512, 1024)
    """
    if longest is None:
        return shape
    scale = longest / max(shape)
    return max(round(shape[0] * scale), 1), max(round(shape[1] * scale), 1)


def fitted_within(shape: tuple[int, int], longest: int) -> tuple[int, int]:
    """Return (H, W) scaled down so that the longer side is at most ``longest``.

    >>> fitted_within((300, 600), 1024), fitted_within((300, 600), 300)
    ((300, 600), (150, 300))
    """
    return fitted(shape, min(longest, max(shape)))


def read_picture(path: Path, content: bytes | None = None, longest: int | None = None) -> Picture:
    """Return a drawing of any mode and format, upright; a very large drawing is reduced.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.
        longest: longer side in pixels at which an SVG is rendered; None uses `SVG_SIDE`.

    Raises:
        InputError: if the file is missing, not an image, or too small or large.
    """
    return to_picture(read_pixels(path, content, min(longest or SVG_SIDE, MOST_WORKED), MOST_WORKED))


def to_picture(decoded: Decoded) -> Picture:
    """Return decoded pixels of any kind as a picture."""
    values, alpha = to_unit(decoded.pixels), None
    full = decoded.shape if decoded.shape != values.shape[:2] else None
    if values.ndim == 2:
        grey = np.asarray(cv2.cvtColor(values, cv2.COLOR_GRAY2RGB), np.float32)
        return Picture(grey, None, full, decoded.notes)
    if values.shape[2] == 4:
        values, alpha = values[..., :3], values[..., 3]
        alpha = alpha if alpha.min() < 1 else None
    return Picture(values, alpha, full, decoded.notes)


def to_pixels(picture: Picture) -> Decoded:
    """Return a picture as 8-bit pixels; the inverse of `to_picture`."""
    channels = picture.colour if picture.alpha is None else np.dstack([picture.colour, picture.alpha])
    return Decoded(np.rint(255 * np.clip(channels, 0, 1)).astype(np.uint8), picture.size)
