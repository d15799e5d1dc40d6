"""Inputs: a drawing, its mask and its hints as files, arrays or images of Pillow, each checked first."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import BoolMask, Floats
from normalgan.decoding import Decoded
from normalgan.decoding.decoders.pictures import plain, reduced, turned_upright
from normalgan.errors import InputError, brief
from normalgan.inference.mask.mask_files import SOURCES, MaskOrSource, load_mask, mask_of
from normalgan.inference.preparation import Prepared, prepare
from normalgan.inference.reading.drawings import LARGEST, SMALLEST
from normalgan.inference.reading.hint_files import Hints, load_hints, parse_hints
from normalgan.inference.reading.picture import MOST_WORKED, Picture, read_picture, to_picture
from normalgan.line_widths import USUAL_WIDTHS, LineWidths
from normalgan.normals import LEAST_Z, normalize

__all__ = [
    "AnyHints",
    "AnyMask",
    "AnyPicture",
    "as_hints",
    "as_mask",
    "as_picture",
    "check_any",
    "check_size",
    "prepare_any",
]

AnyPicture = str | Path | Image.Image | NDArray[Any] | Picture
AnyMask = str | Path | Image.Image | NDArray[Any] | None
AnyHints = str | Path | Sequence[dict[str, Any]] | NDArray[Any] | Hints | None

_MASK = "the mask"
_WANTED = "give a path, an array or an image of Pillow"


def prepare_any(
    image: AnyPicture,
    network_size: int,
    hints: AnyHints = None,
    mask: AnyMask = None,
    size: int | None = None,
    line_widths: LineWidths = USUAL_WIDTHS,
    flips: Sequence[tuple[float, float]] = (),
) -> Prepared:
    """Prepare a drawing for the network.

    Args:
        image: a path; an image of Pillow; or an array (H, W), (H, W, 3) or (H, W, 4) of uint8, uint16, or
            floats from 0 to 1, dark lines on light paper or light ones on dark.
        network_size: side of the network's pictures in pixels.
        hints: a path; a list of ``{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}`` in pixels of the drawing from
            its upper left; or an array (H, W, 4), a unit normal and 1 at each hint, and 0 elsewhere.
        mask: where the object is: a path, an image or an array of the drawing's size, bool, or white on
            black; ``outline`` fills what lines enclose, ``reader`` lets a small network vote on that,
            ``model`` leaves it to the network of normals; None takes the drawing's opacity if it shows the
            object, else the reader.
        size: longer side of the map in pixels, 8 to 8192; None is the drawing's.
        line_widths: widths of lines that the network sees as they were drawn, in its pixels.
        flips: x and y of points whose regions become holes, or object if they are holes.

    Raises:
        InputError: if something cannot be used.
    """
    picture, where, points = check_any(image, hints, mask, size)
    return prepare(picture, network_size, where, points, size, line_widths=line_widths, flips=flips)


def check_any(
    image: AnyPicture, hints: AnyHints, mask: AnyMask, size: int | None
) -> tuple[Picture, MaskOrSource, Hints | None]:
    """Return a drawing, its mask and its hints, given in any form, as `prepare` takes them.

    Raises:
        InputError: if something cannot be used.
    """
    check_size(size)
    picture = as_picture(image, size)
    if isinstance(mask, str) and (source := SOURCES.get(mask)):
        return picture, source, as_hints(hints, picture.shape)
    return picture, as_mask(mask, picture.shape), as_hints(hints, picture.shape)


def check_size(size: int | None) -> None:
    """Raise `InputError` if a map cannot have this longer side."""
    if size is None:
        return
    if not isinstance(size, int | np.integer) or isinstance(size, bool):
        raise InputError(f"size is {size!r}; it is a whole number of pixels, or None.")
    if not SMALLEST <= size <= LARGEST:
        raise InputError(f"size is {size}; a map has {SMALLEST} to {LARGEST} pixels a side.")


def as_picture(image: AnyPicture, svg_side: int | None = None, name: str = "the image") -> Picture:
    """Return a drawing in any form as a picture.

    Args:
        image: a path, an image of Pillow, an array, or a picture.
        svg_side: longer side in pixels that an SVG is drawn with.
        name: name of an image or an array in errors.

    Raises:
        InputError: if it cannot be used.
    """
    match image:
        case Picture():
            return image
        case str() | Path():
            return read_picture(Path(image), None, svg_side)
        case Image.Image():
            _check_sides(name, image.height, image.width)
            try:
                return _decoded(turned_upright(image))
            except (OSError, SyntaxError) as error:  # Pillow reads the pixels when they are asked for
                raise InputError(f"{name} cannot be read: {brief(error)}.") from None
        case np.ndarray():
            return _of_array(image, name)
        case _:
            raise InputError(f"{name} is of the type {type(image).__name__}; {_WANTED}.")


def as_mask(mask: AnyMask, shape: tuple[int, int]) -> BoolMask | None:
    """Return the object (H, W) that a mask in any form shows.

    Raises:
        InputError: if it cannot be used.
    """
    match mask:
        case None:
            return None
        case str() | Path():
            return load_mask(Path(mask), shape)
        case np.ndarray() if mask.dtype == np.bool_:
            return mask_of(as_picture(mask.astype(np.uint8) * np.uint8(255), name=_MASK), shape)
        case Image.Image() | np.ndarray():
            return mask_of(as_picture(mask, name=_MASK), shape)
        case _:
            raise InputError(f"{_MASK} is of the type {type(mask).__name__}; {_WANTED}.")


def as_hints(hints: AnyHints, shape: tuple[int, int]) -> Hints | None:
    """Return hints in any form for a drawing of (H, W) pixels; None for none.

    Raises:
        InputError: if they cannot be used; it says which hint is wrong.
    """
    match hints:
        case None | Hints():
            found = hints
        case str() | Path():
            found = load_hints(Path(hints), shape)
        case np.ndarray():
            found = _hints_in(hints, shape)
        case list() | tuple():
            found = parse_hints([_plain_hint(each) for each in hints], "the list", shape)
        case _:
            raise InputError(
                f"the hints are of the type {type(hints).__name__}; give a path, a list or an array."
            )
    return found if found is not None and len(found.points) else None


def _plain_hint(given: Any) -> Any:
    """Return a hint with NumPy numbers replaced by Python's."""
    if isinstance(given, Mapping):
        return {key: _plain_hint(value) for key, value in given.items()}
    if isinstance(given, np.ndarray | np.generic):
        return given.tolist()
    return [_plain_hint(value) for value in given] if isinstance(given, list | tuple) else given


def _hints_in(array: NDArray[Any], shape: tuple[int, int]) -> Hints:
    """Return the hints in an array (H, W, 4)."""
    if array.shape != (*shape, 4) or not np.issubdtype(array.dtype, np.floating):
        raise InputError(
            f"the hints are an array of {array.dtype} with the shape {array.shape}; for this drawing they "
            f"are floats with the shape {(*shape, 4)}: x, y, z of the normal, and 1 where there is a hint."
        )
    odd = np.argwhere((array[..., 3] != 0) & (array[..., 3] != 1))
    if len(odd):
        row, column = odd[0]
        raise InputError(
            f"the hints have {array[row, column, 3]:.3g} at x {column}, y {row} as their fourth value; it is "
            "1 where there is a hint, and 0 elsewhere."
        )
    rows, columns = np.nonzero(array[..., 3])
    normals = array[rows, columns, :3].astype(np.float32)
    length = np.linalg.norm(normals, axis=1)
    wrong = np.flatnonzero(~(np.abs(length - 1) <= 0.25))  # so that what is not a number is wrong
    if len(wrong):
        first = wrong[0]
        raise InputError(
            f"the hint at x {columns[first]}, y {rows[first]} has length {length[first]:.3g}; "
            "a normal has length 1."
        )
    away = np.flatnonzero(normals[:, 2] < LEAST_Z * length)
    if len(away):
        first = away[0]
        raise InputError(
            f"the hint at x {columns[first]}, y {rows[first]} has z {normals[first, 2]:.3g} and looks away "
            "from the viewer; the z of a normal must be 0 or more."
        )
    points = np.stack([columns, rows], axis=1).astype(np.float32) + np.float32(0.5)
    return Hints(points, normalize(normals))


def _decoded(image: Image.Image) -> Picture:
    """Convert an image as if it had been read from a file: the same mode, and reduced if large."""
    full = (image.height, image.width)
    image = plain(image)
    if max(full) > MOST_WORKED:
        image = reduced(image, MOST_WORKED)
    return to_picture(Decoded(np.asarray(image), full))


def _of_array(array: NDArray[Any], name: str) -> Picture:
    """Return an array of pixels as a picture."""
    if array.ndim not in {2, 3} or (array.ndim == 3 and array.shape[2] not in {3, 4}):
        raise InputError(
            f"{name} has the shape {array.shape}; an array has (H, W), (H, W, 3) or (H, W, 4), rows first."
        )
    _check_sides(name, *array.shape[:2])
    if array.dtype == np.uint8 and array.max() == 1:
        raise InputError(
            f"{name} is an array of uint8 whose largest value is 1; white is 255, or 1 in an array of floats."
        )
    if array.dtype == np.uint8 or (array.dtype == np.uint16 and array.ndim == 2):  # as Pillow has them
        return _decoded(Image.fromarray(np.ascontiguousarray(array)))
    levels = _levels(name, array)
    if levels.ndim == 2:
        levels = np.repeat(levels[..., None], 3, axis=-1)
    alpha = levels[..., 3] if levels.shape[2] == 4 else None
    opaque = alpha is None or bool(alpha.min() == 1)
    return Picture(np.ascontiguousarray(levels[..., :3]), None if opaque else alpha)


def _levels(name: str, array: NDArray[Any]) -> Floats:
    """Return the values of an array of pixels, in [0, 1]."""
    if array.dtype in {np.dtype(np.uint8), np.dtype(np.uint16)}:
        return np.asarray(array / np.float32(np.iinfo(array.dtype).max), np.float32)
    if not np.issubdtype(array.dtype, np.floating):
        raise InputError(
            f"{name} is an array of {array.dtype}; give uint8 from 0 to 255, uint16 from 0 to 65535, or "
            "floats from 0 to 1."
        )
    least, most = float(array.min()), float(array.max())
    if not (least >= 0 and most <= 1):  # so that what is not a number is refused too
        raise InputError(f"{name} has floats from {least:g} to {most:g}; black is 0 and white is 1.")
    return array.astype(np.float32)


def _check_sides(name: str, height: int, width: int) -> None:
    if not SMALLEST <= min(height, width) <= max(height, width) <= LARGEST:
        raise InputError(
            f"{name} is {width} × {height} pixels; a drawing has {SMALLEST} to {LARGEST} a side."
        )
