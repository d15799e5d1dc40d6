"""Drawings: read pictures and normal maps, and find the files that go with a drawing."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from normalgan.arrays import Floats
from normalgan.decoding import Decoded, DecodedPixels, decode
from normalgan.decoding.decoders.formats import ENDINGS, LAYERED
from normalgan.decoding.decoders.levels import float_white
from normalgan.errors import InputError
from normalgan.files.limits import read_bounded, refuse_pointer
from normalgan.normals import Green, flip_green, read_exr, vectors

__all__ = [
    "LARGEST",
    "LAYERED",
    "MOST_BYTES",
    "SMALLEST",
    "SUFFIXES",
    "SVG_SIDE",
    "find_companion",
    "is_drawing",
    "read_content",
    "read_drawing",
    "read_normals",
    "read_pixels",
    "to_unit",
    "without_companions",
]


SUFFIXES = ENDINGS
SVG_SIDE = 1024
"""Default longer side in pixels at which an SVG is rendered."""
SMALLEST, LARGEST = 8, 8192
"""Minimum and maximum side in pixels; a smaller picture cannot hold lines, and a larger one is a mistake or a
decompression bomb."""
MOST_BYTES = 2**29
"""Maximum size of a file in bytes: that of the largest picture, uncompressed, with 16 bits per channel."""


def is_drawing(path: Path) -> bool:
    """Return whether a file in a folder is a drawing, judging by its name.

    Hidden files are not drawings: paint programs use them for temporary files, and macOS for metadata on
    foreign file systems.

    >>> [is_drawing(Path(name)) for name in ("fox.png", "fox.txt", "._fox.png")]
    [True, False, False]
    """
    return path.suffix.lower() in SUFFIXES and not path.name.startswith(".")


def find_companion(
    drawing: Path, source: Path, endings: Sequence[str], below: Path | None = None
) -> Path | None:
    """Return the companion file of a drawing, such as its hints or its mask; None if there is none.

    Args:
        drawing: file of the drawing.
        source: the companion file itself, or a folder of companion files.
        endings: possible endings after the drawing's stem, in order of preference.
        below: subfolder of ``source`` that is searched first.
    """
    if source.is_file():
        return source
    folders = dict.fromkeys([source / (below or ""), source])
    candidates = [folder / f"{drawing.stem}{ending}" for folder in folders for ending in endings]
    # The companion may lie next to its drawing, but a drawing is not its own companion.
    return next((c for c in candidates if c.is_file() and c.resolve() != drawing.resolve()), None)


def without_companions(paths: Sequence[Path], companions: Sequence[str]) -> list[Path]:
    """Return paths without those whose name is another path's stem plus one of ``companions``."""
    stems = {path.with_suffix("") for path in paths}
    return [
        path
        for path in paths
        if not any(
            path.stem.endswith(each) and path.with_name(path.stem.removesuffix(each)) in stems
            for each in companions
        )
    ]


def read_content(path: Path, content: bytes | None = None) -> bytes:
    """Return the bytes of a drawing's file.

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.

    Raises:
        InputError: if the file is missing, cannot be read, or is too large.
    """
    try:
        data = read_bounded(path, MOST_BYTES) if content is None else content
    except FileNotFoundError:
        raise InputError(f"there is no file {path}.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read as an image: {error.strerror}.") from None
    refuse_pointer(path, data)
    if len(data) > MOST_BYTES:
        raise InputError(f"{path} has more than {MOST_BYTES} bytes; a drawing is smaller.")
    return data


def read_pixels(
    path: Path,
    content: bytes | None = None,
    svg_side: int = SVG_SIDE,
    longest: int | None = None,
    grey: bool = False,
    exact: bool = False,
) -> Decoded:
    """Return the pixels of a picture in any format, upright; an SVG is rendered on a transparent background.

    All pictures are decoded here, in a child process (`normalgan.decoding`).

    Args:
        path: the file, or its name in messages.
        content: content of the file, if it has been read already.
        svg_side: longer side in pixels at which an SVG is rendered.
        longest: longer side in pixels to which larger pictures are reduced; None keeps their size.
        grey: whether only the brightness on white paper is returned.
        exact: whether the stored values are returned, including 16 bits per channel and floats.

    Raises:
        InputError: if the file is missing, not an image, of an invalid size, or too expensive to decode.
    """
    data = read_content(path, content)
    return decode(str(path), data, (SMALLEST, LARGEST), svg_side, longest, grey, exact)


def to_unit(pixels: DecodedPixels) -> Floats:
    """Return pixels of any type scaled to [0, 1]."""
    if pixels.dtype == np.uint8:
        return np.multiply(pixels, np.float32(1 / 255), dtype=np.float32)
    grey = pixels.astype(np.float32)
    top = np.float32(65535)  # 16-bit grey may be stored as uint16 or int32
    if pixels.dtype == np.float32:
        top = np.float32(float_white(float(np.nan_to_num(grey).max(initial=0))))
    return np.asarray(np.clip(np.nan_to_num(grey / top), 0, 1), np.float32)


def read_drawing(path: str | Path) -> Floats:
    """Return a drawing of any mode as ink (H, W) in [0, 1]; paper and transparent pixels are 0.

    Raises:
        InputError: if the file is missing, not an image, too small or large, or has no lines.
    """
    path = Path(path)
    ink = np.float32(1) - to_unit(read_pixels(path, grey=True).pixels)
    if ink.max() < 0.1:
        raise InputError(f"{path} is all white; a sketch needs dark lines on light paper.")
    return ink


def read_normals(path: str | Path, green: Green = "up") -> tuple[Floats, Floats | None]:
    """Read a normal map from a PNG or TIFF with 8 or 16 bits per channel, or a TIFF or EXR of floats.

    Args:
        path: path of the file.
        green: direction of green in the file: up for OpenGL, down for DirectX.

    Returns:
        The vectors (H, W, 3), y up, not normalised; and the opacity (H, W) in [0, 1], or None.

    Raises:
        InputError: if the file is missing, cannot be read, or is grey.
    """
    path = Path(path)
    pixels = (
        read_exr(path, LARGEST) if path.suffix.lower() == ".exr" else read_pixels(path, exact=True).pixels
    )
    if pixels.ndim == 2 or (pixels[..., :1] == pixels[..., 1:3]).all():  # decoded as colours with opacity
        raise InputError(f"{path} is grey; a normal map needs three channels.")
    found = vectors(pixels[..., :3])
    alpha = to_unit(pixels[..., 3]) if pixels.shape[2] == 4 else None
    return flip_green(found) if green == "down" else found, alpha
