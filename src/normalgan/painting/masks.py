"""Masks: pictures that say where the object is in a drawing."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.painting.picture import read_picture


def find_mask(drawing: Path, source: Path) -> Path | None:
    """Return the mask of a drawing: the file itself, or the one of its name in a folder."""
    if source.is_file():
        return source
    candidates = [source / f"{drawing.stem}{ending}" for ending in ("_mask.png", ".png")]
    return next((c for c in candidates if c.is_file() and c.resolve() != drawing.resolve()), None)


def load_mask(path: Path, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Read the mask of a drawing: the object is white on black, or opaque on nothing.

    Args:
        path: its file.
        shape: (H, W) of the drawing, which the mask must have too.

    Returns:
        (h, w): of a larger one than is worked on a reduced one.

    Raises:
        InputError: if it cannot be used.
    """
    picture = read_picture(path)
    if picture.shape != shape:
        raise InputError(
            f"the mask {path} is {picture.shape[1]} × {picture.shape[0]} pixels, "
            f"but its sketch {shape[1]} × {shape[0]}."
        )
    level = picture.colour.mean(-1) if picture.alpha is None else picture.alpha
    mask: NDArray[np.bool_] = level > 0.5
    if not mask.any():
        raise InputError(f"the mask {path} is empty; paint the object white, and the rest black.")
    return mask
