"""Mask files: pictures that say where the object is in a drawing, and the names of the other sources."""

from pathlib import Path
from typing import Literal

from normalgan.arrays import BoolMask
from normalgan.errors import InputError
from normalgan.inference.reading.picture import Picture, read_picture

__all__ = [
    "ENDINGS",
    "MODEL",
    "OUTLINE",
    "READER",
    "SOURCES",
    "MaskOrSource",
    "MaskSource",
    "load_mask",
    "mask_of",
]

MaskSource = Literal["outline", "model", "reader"]
"""Where a mask may come from: what lines enclose, the network of normals, or the reader's vote."""
OUTLINE: MaskSource = "outline"
MODEL: MaskSource = "model"
READER: MaskSource = "reader"
SOURCES: dict[str, MaskSource] = {OUTLINE: OUTLINE, MODEL: MODEL, READER: READER}
"""The sources by the words that users give."""
MaskOrSource = BoolMask | MaskSource | None
"""The object (h, w), or where it comes from; None is the opacity if that tells, else the reader."""

ENDINGS = ("_mask.png", ".png")
"""What the mask of a drawing is named, after its stem, in the order in which they are looked for."""


def mask_of(picture: Picture, shape: tuple[int, int], name: str = "the mask") -> BoolMask:
    """Return the object (H, W) of a mask picture: its opaque part, or else its white part.

    If anything is transparent, only the opacity counts, not the colour.

    Args:
        picture: of the mask.
        shape: (H, W) of the drawing.
        name: what to call the mask in an error.

    Raises:
        InputError: if it is of another size, or empty.

    Example:
        >>> import numpy as np
        >>> black, clear = np.zeros((8, 8, 3), np.float32), np.zeros((8, 8), np.float32)
        >>> clear[2:4] = 1
        >>> int(mask_of(Picture(black, clear), (8, 8)).sum())
        16
    """
    if picture.shape != shape:
        raise InputError(
            f"{name} is {picture.shape[1]} × {picture.shape[0]} pixels, "
            f"but its sketch {shape[1]} × {shape[0]}."
        )
    mask: BoolMask = picture.colour.mean(-1) > 0.5
    if picture.alpha is not None and (picture.alpha <= 0.5).any():
        mask = picture.alpha > 0.5
    if not mask.any():
        raise InputError(f"{name} is empty; paint the object white, and the rest black.")
    return mask


def load_mask(path: Path, shape: tuple[int, int]) -> BoolMask:
    """Read the mask (h, w) of a drawing of (H, W) pixels; see `mask_of`.

    A mask above the working size is reduced.

    Raises:
        InputError: if it cannot be used.
    """
    return mask_of(read_picture(path), shape, f"the mask {path}")
