"""Inputs: check drawings, masks and hints given as files, arrays or Pillow images."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

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
from normalgan.inference.reading.hint_files import Hints, first_fault, hints_at, load_hints, parse_hints
from normalgan.inference.reading.picture import MOST_WORKED, Picture, read_picture, to_picture
from normalgan.line_widths import USUAL_WIDTHS, LineWidths


@runtime_checkable
class ArrayLike(Protocol):
    """An array that NumPy can read: its own, or one of another library, such as a tensor of PyTorch."""

    def __array__(self) -> NDArray[Any]:
        """Return the array of NumPy."""
        ...


AnyPicture = str | Path | Image.Image | ArrayLike | Picture
AnyMask = str | Path | Image.Image | ArrayLike | None
AnyHints = str | Path | Sequence[dict[str, Any]] | ArrayLike | Hints | None

_MASK = "the mask"
_WANTED = "give a path, an array or an image of Pillow"


def prepare_any(
    image: AnyPicture,
    network_size: int,
    hints: AnyHints = None,
    mask: AnyMask = None,
    size: int | None = None,
    line_widths: LineWidths = USUAL_WIDTHS,
) -> Prepared:
    """Return a drawing in any form, prepared for the network.

    Args:
        image: a path; a Pillow image; or an array (H, W), (H, W, 3) or (H, W, 4) of uint8, uint16, or floats
            from 0 to 1. Lines may be dark on light or light on dark.
        network_size: side of the network's input in pixels.
        hints: a path; a list of ``{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}`` in pixels from the drawing's
            upper left corner; or an array (H, W, 4) with a unit normal and 1 at each hint, and 0 elsewhere.
        mask: the object, as a path, an image or an array of the drawing's size, either bool or white on
            black; or a source: ``outline`` fills the areas that lines enclose, ``reader`` lets a small
            network decide on each of these areas, ``model`` uses the network's own segmentation. None uses
            the drawing's opacity if it shows the object, otherwise the reader.
        size: longer side of the map in pixels, 8 to 8192; None keeps the drawing's size.
        line_widths: range of line widths, in pixels of the network, that are kept as drawn.

    Raises:
        InputError: if an argument is invalid.
    """
    picture, where, points = check_any(image, hints, mask, size)
    return prepare(picture, network_size, where, points, size, line_widths=line_widths)


def check_any(
    image: AnyPicture, hints: AnyHints, mask: AnyMask, size: int | None
) -> tuple[Picture, MaskOrSource, Hints | None]:
    """Convert a drawing, its mask and its hints from any form to the types that `prepare` takes.

    Raises:
        InputError: if an argument is invalid.
    """
    check_size(size)
    picture = as_picture(image, size)
    if isinstance(mask, str) and (source := SOURCES.get(mask)):
        return picture, source, as_hints(hints, picture.shape)
    return picture, as_mask(mask, picture.shape), as_hints(hints, picture.shape)


def check_size(size: int | None) -> None:
    """Raise `InputError` if ``size`` is not a valid longer side of a map."""
    if size is None:
        return
    if not isinstance(size, int | np.integer) or isinstance(size, bool):
        raise InputError(f"size is {size!r}; it is a whole number of pixels, or None.")
    if not SMALLEST <= size <= LARGEST:
        raise InputError(f"size is {size}; a map has {SMALLEST} to {LARGEST} pixels a side.")


def as_picture(image: AnyPicture, svg_side: int | None = None, name: str = "the image") -> Picture:
    """Return a drawing in any form as a picture.

    Args:
        image: a path, a Pillow image, an array, or a picture.
        svg_side: longer side in pixels at which an SVG is rendered.
        name: name for an image or array in error messages.

    Raises:
        InputError: if the drawing is invalid.
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
            except (OSError, SyntaxError) as error:  # Pillow decodes lazily
                raise InputError(f"{name} cannot be read: {brief(error)}.") from None
        case ArrayLike():
            return _of_array(_array(image, name), name)
        case _:
            raise InputError(f"{name} is of the type {type(image).__name__}; {_WANTED}.")


def as_mask(mask: AnyMask, shape: tuple[int, int]) -> BoolMask | None:
    """Return a mask in any form as an array (H, W).

    Raises:
        InputError: if the mask is invalid.
    """
    match mask:
        case None:
            return None
        case str() | Path():
            return load_mask(Path(mask), shape)
        case Image.Image():
            return mask_of(as_picture(mask, name=_MASK), shape)
        case ArrayLike():
            array = _array(mask, _MASK)
            levels = array.astype(np.uint8) * np.uint8(255) if array.dtype == np.bool_ else array
            return mask_of(as_picture(levels, name=_MASK), shape)
        case _:
            raise InputError(f"{_MASK} is of the type {type(mask).__name__}; {_WANTED}.")


def as_hints(hints: AnyHints, shape: tuple[int, int]) -> Hints | None:
    """Return hints in any form for a drawing (H, W); None if there are none.

    Raises:
        InputError: if a hint is invalid; the message says which one.
    """
    match hints:
        case None | Hints():
            found = hints
        case str() | Path():
            found = load_hints(Path(hints), shape)
        case ArrayLike():
            found = _hints_in(_array(hints, "the hints"), shape)
        case list() | tuple():
            found = parse_hints([_plain_hint(each) for each in hints], "the list", shape)
        case _:
            raise InputError(
                f"the hints are of the type {type(hints).__name__}; give a path, a list or an array."
            )
    return found if found is not None and len(found.points) else None


def _array(given: ArrayLike, name: str) -> NDArray[Any]:
    """Return an array of any library as NumPy's.

    Raises:
        InputError: if the library refuses, as PyTorch does for a tensor on a GPU or one that needs gradients.
    """
    try:
        return np.asarray(given)
    except (RuntimeError, TypeError, ValueError) as error:
        raise InputError(f"{name} cannot be read as an array of NumPy: {brief(error).rstrip('.')}.") from None


def _plain_hint(given: Any) -> Any:
    """Return a hint with values of NumPy or PyTorch converted to Python numbers."""
    if isinstance(given, Mapping):
        return {key: _plain_hint(value) for key, value in given.items()}
    if isinstance(given, ArrayLike):
        return _array(given, "a hint").tolist()
    return [_plain_hint(value) for value in given] if isinstance(given, list | tuple) else given


def _hints_in(array: NDArray[Any], shape: tuple[int, int]) -> Hints:
    """Return the hints of an array (H, W, 4)."""
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
    if fault := first_fault(normals):
        first, length = fault
        hint = f"the hint at x {columns[first]}, y {rows[first]} has"
        if length is None:
            raise InputError(
                f"{hint} z {normals[first, 2]:.3g} and looks away from the viewer; the z of a normal "
                "must be 0 or more."
            )
        raise InputError(f"{hint} length {length:.3g}; a normal has length 1.")
    return hints_at(rows, columns, normals)


def _decoded(image: Image.Image) -> Picture:
    """Return an image as a picture, with the same conversions as for files."""
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
    if array.dtype == np.uint8 or (array.dtype == np.uint16 and array.ndim == 2):  # Pillow has these modes
        return _decoded(Image.fromarray(np.ascontiguousarray(array)))
    levels = _levels(name, array)
    if levels.ndim == 2:
        levels = np.repeat(levels[..., None], 3, axis=-1)
    alpha = levels[..., 3] if levels.shape[2] == 4 else None
    opaque = alpha is None or bool(alpha.min() == 1)
    return Picture(np.ascontiguousarray(levels[..., :3]), None if opaque else alpha)


def _levels(name: str, array: NDArray[Any]) -> Floats:
    """Return an array of pixels scaled to [0, 1]."""
    if array.dtype in {np.dtype(np.uint8), np.dtype(np.uint16)}:
        return np.asarray(array / np.float32(np.iinfo(array.dtype).max), np.float32)
    if not np.issubdtype(array.dtype, np.floating):
        raise InputError(
            f"{name} is an array of {array.dtype}; give uint8 from 0 to 255, uint16 from 0 to 65535, or "
            "floats from 0 to 1."
        )
    least, most = float(array.min()), float(array.max())
    if not (least >= 0 and most <= 1):  # written so that NaN is refused too
        raise InputError(f"{name} has floats from {least:g} to {most:g}; black is 0 and white is 1.")
    return array.astype(np.float32)


def _check_sides(name: str, height: int, width: int) -> None:
    if not SMALLEST <= min(height, width) <= max(height, width) <= LARGEST:
        raise InputError(
            f"{name} is {width} × {height} pixels; a drawing has {SMALLEST} to {LARGEST} a side."
        )
