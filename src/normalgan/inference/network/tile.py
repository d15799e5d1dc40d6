"""Tile: pad, crop and resize pictures that repeat across their edges."""

from typing import Any, Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.reading.picture import resize

Tile = Literal["both", "x", "y"]
"""Directions in which a picture repeats: horizontally (x), vertically (y) or both."""
_REACH = 4
"""Padding in pixels when a picture is enlarged; interpolation needs two."""


def check_tile(tile: str | None) -> None:
    """Raise `InputError` if ``tile`` is not a valid direction."""
    if tile is not None and tile not in get_args(Tile):
        raise InputError(f"tile is {tile!r}; a drawing is repeated along x, y or both.")


def repeats(tile: Tile | None) -> tuple[bool, bool]:
    """Return whether the map repeats vertically, and whether it repeats horizontally.

    >>> repeats("x"), repeats(None)
    ((False, True), (False, False))
    """
    return tile in {"both", "y"}, tile in {"both", "x"}


def wrapped(picture: NDArray[Any], tile: Tile | None, beside: tuple[int, int]) -> NDArray[Any]:
    """Return a picture (H, W, …) padded with its own repeats.

    >>> wrapped(np.array([[1, 2, 3]]), "x", (1, 1)).tolist()
    [[3, 1, 2, 3, 1]]
    """
    if tile is None:
        return picture
    room = [(n, n) if there else (0, 0) for n, there in zip(beside, repeats(tile), strict=True)]
    return np.pad(picture, room + [(0, 0)] * (picture.ndim - 2), mode="wrap")


def middle(picture: NDArray[Any], tile: Tile | None, beside: tuple[int, int]) -> NDArray[Any]:
    """Return a picture without the padding of `wrapped`.

    >>> middle(np.array([[3, 1, 2, 3, 1]]), "x", (1, 1)).tolist()
    [[1, 2, 3]]
    """
    top, left = (n if there else 0 for n, there in zip(beside, repeats(tile), strict=True))
    return picture[top : picture.shape[0] - top, left : picture.shape[1] - left]


def resize_tile(picture: Floats, shape: tuple[int, int], tile: Tile | None) -> Floats:
    """Return a repeating picture (H, W) or (H, W, C) resized so that it still repeats; see `resize`."""
    if tile is None or shape[0] <= picture.shape[0]:  # area averaging does not reach across an edge
        return resize(picture, shape)
    around = wrapped(picture, tile, (_REACH, _REACH))
    down, right = (picture.shape[axis] / shape[axis] for axis in (0, 1))
    top, left = (_REACH if there else 0 for there in repeats(tile))
    # This maps pixel centres of the larger picture to pixel centres of the smaller one.
    back = np.array([[right, 0, left + (right - 1) / 2], [0, down, top + (down - 1) / 2]], np.float64)
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    return np.asarray(
        cv2.warpAffine(around, back, shape[::-1], flags=flags, borderMode=cv2.BORDER_REPLICATE), np.float32
    )
