"""Normal maps: axes, encoding and files. All readers and writers use this module; it does not need torch.

Normals are in camera space, as in OpenGL: x right, y up, z to the viewer. A unit vector n is stored as the
colour (n + 1) / 2. Outside the object, a map is zero in memory and flat, (0, 0, 1), in a file.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Doubles, Floats
from normalgan.errors import InputError, brief
from normalgan.files.limits import refuse_pointer

Bits = Literal[8, 16]
Green = Literal["up", "down"]
"""Direction of y that a file's green channel stores: up as in OpenGL, down as in DirectX."""
LEAST_Z = -0.02
"""A unit normal with a z below this faces away; a z between this and 0 may be rounding to 8 bits."""
_STRIP = 2**16
"""Number of values in a strip; intermediate arrays of this size fit into a CPU cache."""


def normalize(vectors: NDArray[np.floating], eps: float = 1e-8) -> Floats:
    """Return unit vectors along the last axis; vectors shorter than ``eps`` become zero.

    >>> normalize(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])).tolist()
    [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]
    """
    vectors = vectors.astype(np.float32)
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > eps, vectors / np.maximum(length, eps), 0).astype(np.float32)


def angles(one: NDArray[np.floating], other: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the angles in degrees between nonzero vectors (..., 3), in the precision of the inputs.

    >>> float(angles(np.array([1.0, 0.0, 0.0]), np.array([1.0, 1.0, 0.0])).round(3))
    45.0
    """
    # atan2 of sine and cosine, because the arc cosine is inexact near zero.
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.rad2deg(np.arctan2(sine, (one * other).sum(axis=-1))))


def encode(normals: NDArray[np.floating], bits: Bits = 8) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Return normals of any shape as colours, mapping [-1, 1] to the full range of 8 or 16 bits.

    Values are rounded to the nearest level, so 0 becomes 128 (8 bits) or 32768 (16 bits).

    >>> encode(np.array([0.0, 0.0, 1.0])).tolist()
    [128, 128, 255]
    """
    top = 2**bits - 1
    colours = np.empty(normals.shape, np.uint8 if bits == 8 else np.uint16)
    for strip in strips(normals.shape):
        # In single precision, one in a few hundred boundaries between levels would be off by the last bit.
        levels: Doubles = np.multiply(normals[strip], top / 2, dtype=np.float64)
        levels += top / 2
        colours[strip] = np.clip(np.rint(levels, out=levels), 0, top, out=levels)
    return colours


def strips(shape: tuple[int, ...]) -> Iterator[slice]:
    """Yield slices of rows, so that elementwise computations use the cache.

    Without strips, each step on a large picture would allocate memory for the whole picture.

    >>> list(strips((5, 2**14, 2)))
    [slice(0, 2, None), slice(2, 4, None), slice(4, 6, None)]
    """
    rows = max(_STRIP // max(math.prod(shape[1:]), 1), 1)
    for first in range(0, shape[0], rows):
        yield slice(first, first + rows)


def decode(colours: NDArray[np.uint8] | NDArray[np.uint16]) -> Floats:
    """Return the unit normals (..., 3) of colours; inverts `encode` up to half a level.

    >>> decode(np.array([255, 128, 128], dtype=np.uint8)).round(2).tolist()
    [1.0, 0.0, 0.0]
    """
    return normalize(vectors(colours))


def vectors(levels: NDArray[Any]) -> Floats:
    """Decode the levels of a normal map (..., 3) to vectors without normalising them.

    Float arrays with negative values hold vectors, as in a renderer's normal pass; all others hold
    colours.

    >>> vectors(np.array([255, 0, 51], dtype=np.uint8)).astype(float).round(2).tolist()
    [1.0, -1.0, -0.6]
    >>> vectors(np.array([[0.5, 0.5, 1.0]], dtype=np.float32)).tolist()
    [[0.0, 0.0, 1.0]]
    """
    if np.issubdtype(levels.dtype, np.floating):
        found = np.asarray(levels, np.float32)
        # A renderer may write NaN or infinity where there is no surface.
        return found if ((found < -0.01) & np.isfinite(found)).any() else found * 2 - 1
    top = np.float32(np.iinfo(levels.dtype).max)
    return np.asarray(levels.astype(np.float32) / top * 2 - 1, np.float32)


def flip_green(normals: Floats) -> Floats:
    """Convert vectors (..., 3) between y up (OpenGL) and y down (DirectX)."""
    return normals * np.array([1, -1, 1], dtype=np.float32)


def paint_flat(normals: Floats, mask: BoolMask) -> Floats:
    """Return the map (H, W, 3) with flat normals (0, 0, 1) outside the object, as game engines expect."""
    import cv2  # as below

    flat = np.zeros(normals.shape, np.float32)
    flat[..., 2] = 1
    # NumPy's default path takes twice as long.
    return np.asarray(cv2.copyTo(np.asarray(normals, np.float32), mask.astype(np.uint8), flat), np.float32)


def pad_edge(pixels: NDArray[Any], there: BoolMask, reach: int) -> None:
    """Fill the pixels around an object with the colour of the nearest object pixel, in place.

    Engines blend neighbouring pixels when they scale a texture, so the colours outside an object bleed
    into its rim. A fourth channel, the opacity, is not changed.

    Args:
        pixels: (H, W, C) of any type.
        there: (H, W), mask of the object.
        reach: distance to fill, in pixels.

    Example:
        >>> row = np.array([[[9], [0], [0], [0]]], np.uint8)
        >>> pad_edge(row, np.array([[True, False, False, False]]), 2)
        >>> row.ravel().tolist()
        [9, 9, 9, 0]
    """
    import cv2  # as below

    left, top, width, height = cv2.boundingRect(there.view(np.uint8))
    if not width or reach < 1:
        return
    box = np.s_[max(top - reach, 0) : top + height + reach, max(left - reach, 0) : left + width + reach]
    own, inside = there[box], pixels[box]
    away, nearest = cv2.distanceTransformWithLabels(
        (~own).view(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    rows, columns = np.nonzero(own)
    place = np.zeros((len(rows) + 1, 2), np.intp)
    place[nearest[own]] = np.stack([rows, columns], -1)
    around = ~own & (away <= reach)
    row, column = place[nearest[around]].T
    inside[around, :3] = inside[row, column, :3]


def encode_png(
    normals: NDArray[np.floating], bits: Bits = 8, alpha: NDArray[np.floating] | None = None
) -> bytes:
    """Return a normal map (H, W, 3) as a PNG, with an optional alpha channel (H, W) in [0, 1]."""
    return pack_png(pixels_of(normals, bits, alpha, blue_first=True))


def pixels_of(
    normals: NDArray[np.floating],
    bits: Bits = 8,
    alpha: NDArray[np.floating] | None = None,
    *,
    blue_first: bool = False,
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Return the colours of a normal map, with an optional alpha channel.

    Args:
        normals: (H, W, 3).
        bits: bits per channel.
        alpha: (H, W) in [0, 1], the fourth channel; None for no such channel.
        blue_first: whether the channel order is blue, green, red, as in OpenCV.
    """
    import cv2  # as below

    colours: Any = encode(normals, bits)
    if blue_first:
        colours = cv2.cvtColor(colours, cv2.COLOR_RGB2BGR)
    if alpha is None:
        return np.asarray(colours)
    opacity = np.rint(alpha * (2**bits - 1)).astype(colours.dtype)
    return np.asarray(cv2.merge([colours, opacity]))


def pack_png(pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Return pixels (H, W), (H, W, 3) or (H, W, 4) in BGR order as a PNG."""
    return _encoded(".png", pixels)


def encode_tiff(normals: Floats, alpha: Floats | None = None) -> bytes:
    """Return a normal map as a 32-bit float TIFF: colours (n + 1) / 2 in [0, 1], and optional alpha."""
    return _encoded(".tiff", _float_colours(normals, alpha)[..., [2, 1, 0, 3][: 3 + (alpha is not None)]])


def encode_exr(normals: Floats, alpha: Floats | None = None) -> bytes:
    """Return a normal map as a 32-bit float EXR: colours (n + 1) / 2 in [0, 1], and optional alpha."""
    import OpenEXR

    colours = _float_colours(normals, alpha)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    names = "RGBA"[: colours.shape[2]]
    with TemporaryDirectory() as folder:  # the library writes to files only
        path = Path(folder) / "map.exr"
        OpenEXR.File(header, {names: colours}).write(str(path))
        return path.read_bytes()


def encode_grey(picture: Floats, suffix: Literal[".png", ".tiff"] = ".png", bits: Bits = 8) -> bytes:
    """Return a grey picture (H, W) as a PNG of values in [0, 1], or as a TIFF of any floats."""
    if suffix == ".tiff":
        return _encoded(suffix, np.asarray(picture, np.float32))
    levels = np.rint(np.clip(picture, 0, 1) * (2**bits - 1))
    return _encoded(suffix, levels.astype(np.uint8 if bits == 8 else np.uint16))


def _float_colours(normals: Floats, alpha: Floats | None) -> Floats:
    colours = (normals + 1) / 2
    return np.ascontiguousarray(colours if alpha is None else np.dstack([colours, alpha]), np.float32)


def _encoded(suffix: str, pixels: NDArray[Any]) -> bytes:
    import cv2  # imported here, because `encode` and `decode` do not need it

    done, buffer = cv2.imencode(suffix, pixels)
    if not done:
        raise OSError(f"a normal map of {pixels.shape[1]} × {pixels.shape[0]} could not be encoded.")
    return buffer.tobytes()


def read_exr(path: str | Path, most: int = 8192) -> Floats:
    """Read the levels (H, W, 3), or (H, W, 4) with opacity, of an EXR.

    The channels are R, G, B and A, or X, Y and Z, of the only layer or of a layer with a name ending in
    "normal".

    Args:
        path: path of the file.
        most: maximum side in pixels.

    Raises:
        InputError: if the file is missing, too large, or not such an EXR.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"there is no file {path}.")
    with path.open("rb") as start:
        refuse_pointer(path, start.read(64))
    channels = _exr_channels(path, most)
    layers: dict[str, dict[str, Any]] = {}
    for name, pixels in channels.items():
        layer, _, letter = name.rpartition(".")
        layers.setdefault(layer, {})[letter.upper()] = pixels
    for names in ("RGBA", "RGB", "XYZ"):
        found = [layer for layer, of_layer in layers.items() if set(names) <= set(of_layer)]
        named = [layer for layer in found if layer.lower().endswith("normal")]
        if len(named or found) == 1:
            of_layer = layers[(named or found)[0]]
            return np.stack([np.asarray(of_layer[name], np.float32) for name in names], axis=-1)
    raise InputError(
        f"{path} has the channels {', '.join(sorted(channels))[:80]}; a normal map has R, G, B or X, Y, Z."
    )


def _exr_channels(path: Path, most: int) -> dict[str, Any]:
    """Return the pixels of each channel of an EXR by name, after checking its size."""
    import OpenEXR

    try:
        with OpenEXR.File(str(path), header_only=True) as file:
            low, high = file.header()["dataWindow"]
            width, height = int(high[0] - low[0]) + 1, int(high[1] - low[1]) + 1
            if not 0 < max(height, width) <= most:
                raise InputError(
                    f"{path} is {width} × {height} pixels; a normal map has at most {most} a side."
                )
        with OpenEXR.File(str(path), separate_channels=True) as file:
            return {name: channel.pixels for name, channel in file.channels().items()}
    except InputError:
        raise
    except Exception as error:  # the library raises bare RuntimeErrors, or errors of its bindings
        raise InputError(f"{path} is not an EXR that can be read: {brief(error)}.") from None
