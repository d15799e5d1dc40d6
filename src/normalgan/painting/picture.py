"""Picture: a drawing's file as colours and opacity, before anything is known of its lines."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.drawings import SVG_SIDE, open_image
from normalgan.normals import Floats

MOST_WORKED = 2048
"""Longest side in pixels at which a drawing is worked on; maps of larger ones are enlarged to their size."""


@dataclass(frozen=True)
class Picture:
    """A drawing's colours and opacity.

    Args:
        colour: (H, W, 3) in [0, 1], red, green, blue; not multiplied by the opacity.
        alpha: (H, W) opacity in [0, 1], or None where every pixel is opaque.
    """

    colour: Floats
    alpha: Floats | None

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W)."""
        return self.colour.shape[0], self.colour.shape[1]

    def resized(self, shape: tuple[int, int]) -> "Picture":
        """Return the picture with (H, W) pixels; itself if it has."""
        if shape == self.shape:
            return self
        alpha = self.alpha if self.alpha is not None else np.ones(self.shape, np.float32)
        # Colours of pixels that nobody sees must not bleed into those that are seen.
        seen = resize(np.dstack([self.colour * alpha[..., None], alpha]), shape)
        colour = seen[..., :3] / np.maximum(seen[..., 3:], 1e-4)
        return Picture(np.clip(colour, 0, 1), None if self.alpha is None else np.clip(seen[..., 3], 0, 1))


def resize(picture: Floats, shape: tuple[int, int]) -> Floats:
    """Return a picture (H, W) or (H, W, C) with another (H, W): averaged over areas, or interpolated."""
    shrinks = shape[0] < picture.shape[0]
    method = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, shape[::-1], interpolation=method), np.float32)


def fitted(shape: tuple[int, int], longest: int) -> tuple[int, int]:
    """Return (H, W) of the same proportions whose longer side is ``longest``.

    >>> fitted((300, 600), 1024)
    (512, 1024)
    """
    scale = longest / max(shape)
    return max(round(shape[0] * scale), 1), max(round(shape[1] * scale), 1)


def read_picture(path: Path, content: bytes | None = None, longest: int | None = None) -> Picture:
    """Read a drawing of any mode and format, upright.

    Args:
        path: its file, or what to call it.
        content: what is in it, if it was read already.
        longest: longer side in pixels that an SVG is drawn with; None is `SVG_SIDE`.

    Raises:
        InputError: if it is missing, no image, or of no possible size.
    """
    return to_picture(open_image(path, content, min(longest or SVG_SIDE, MOST_WORKED)))


def to_picture(image: Image.Image) -> Picture:
    """Return an image of Pillow, of any mode, as a picture."""
    if image.mode.startswith("I") or image.mode == "F":
        grey = np.asarray(image, np.float32)
        # 16-bit greys come as I;16, or as I with the same range; a float image has none that is agreed on.
        grey = np.clip(grey / (1 if image.mode == "F" and grey.max() <= 1 else 65535), 0, 1)
        return Picture(np.repeat(grey[..., None], 3, -1), None)
    if image.mode in {"RGBA", "LA", "PA", "RGBa", "La"} or "transparency" in image.info:
        pixels = _unit(np.asarray(image.convert("RGBA")))
        alpha = pixels[..., 3]
        return Picture(pixels[..., :3], alpha if alpha.min() < 1 else None)
    return Picture(_unit(np.asarray(image.convert("RGB"))), None)


def _unit(pixels: NDArray[np.uint8]) -> Floats:
    return np.multiply(pixels, np.float32(1 / 255), dtype=np.float32)
