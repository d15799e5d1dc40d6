"""Mask files: pictures that mark the object in a drawing, and the names of other mask sources."""

from pathlib import Path
from typing import Literal

from normalgan.arrays import BoolMask
from normalgan.errors import InputError
from normalgan.inference.reading.picture import Picture, read_picture

MaskSource = Literal["outline", "model", "reader"]
"""Sources of a mask: the area that lines enclose, the normal network, or the reader's vote."""
OUTLINE: MaskSource = "outline"
MODEL: MaskSource = "model"
READER: MaskSource = "reader"
SOURCES: dict[str, MaskSource] = {OUTLINE: OUTLINE, MODEL: MODEL, READER: READER}
"""The sources by the names that users type."""
MaskOrSource = BoolMask | MaskSource | None
"""The object (h, w), or a source; None uses the opacity if it shows the object, otherwise the reader."""

ENDINGS = ("_mask.png", ".png")
"""Endings that follow a drawing's stem in the name of its mask, in the order of the search."""


def mask_of(picture: Picture, shape: tuple[int, int], name: str = "the mask") -> BoolMask:
    """Return the object (h, w) of a mask picture: its opaque part, or the white part of an opaque picture.

    Args:
        picture: picture of the mask.
        shape: (H, W) of the drawing.
        name: name of the mask in error messages.

    Raises:
        InputError: if the mask is empty or has a different size than the drawing.

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
        top = round(255 * float(picture.colour.max()))
        dark = f": its brightest pixel is {top} of 255" if 0 < top < 128 else ""
        raise InputError(f"{name} is empty{dark}; paint the object white, and the rest black.")
    return mask


def load_mask(path: Path, shape: tuple[int, int]) -> BoolMask:
    """Return the mask (h, w) of a drawing (H, W) from a file; see `mask_of`.

    A mask larger than the working size is reduced.

    Raises:
        InputError: if the file is not a usable mask.
    """
    return mask_of(read_picture(path), shape, f"the mask {path}")
