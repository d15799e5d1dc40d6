"""Drawings of the user's own: finding and reading them, and the hints painted for them."""

import io
from collections.abc import Sequence
from glob import glob
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from normalgan.errors import InputError, brief
from normalgan.limits import read_bounded
from normalgan.normals import normalize

Floats = NDArray[np.float32]

SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff", ".gif", ".svg")
SVG_SIDE = 1024
"""Longer side in pixels that an SVG, which has none, is drawn with."""
_DPI = 96.0
"""What CSS takes an inch for; without it millimetres have no size."""
SMALLEST, LARGEST = 8, 8192
"""Least and greatest side in pixels: less holds no line, more is a mistake or a decompression bomb."""
MOST_BYTES = 2**29
"""Larger files are refused; the largest picture has as many with 16 bits a channel, not packed at all."""


def find_drawings(
    source: str | Sequence[str], ending: str = "_normal.png", companions: Sequence[str] = ()
) -> list[Path]:
    """Return the drawings in a folder, matched by a glob, or listed, in order of their names.

    Args:
        source: folder, glob, file or a list of them.
        ending: what is written for a drawing is named its stem with this.
        companions: what lies beside a drawing in a folder or a glob and is named its stem with one of these,
            such as ``_hints``, is no drawing.

    Raises:
        InputError: if something named is missing, or nothing is found, or two have one name.
    """
    paths: list[Path] = []
    for entry in [source] if isinstance(source, str) else source:
        if Path(entry).is_dir():
            found = [path for path in Path(entry).iterdir() if path.suffix.lower() in SUFFIXES]
        elif Path(entry).is_file():
            found = [Path(entry)]
        else:
            found = [Path(match) for match in glob(entry, recursive=True) if Path(match).is_file()]
        if not found:
            raise InputError(
                f"no sketch found at {entry!r}; give a folder, a file or a glob of {' '.join(SUFFIXES)}."
            )
        if not Path(entry).is_file():
            found = _without_companions(found, companions)
        paths += sorted(path for path in found if path not in paths)  # patterns may overlap
    by_name: dict[str, Path] = {}
    for path in paths:
        other = by_name.setdefault(path.stem, path)
        if other is not path:
            raise InputError(f"{other} and {path} would both be written as {path.stem}{ending}; rename one.")
    return paths


def _without_companions(paths: Sequence[Path], companions: Sequence[str]) -> list[Path]:
    stems = {path.with_suffix("") for path in paths}
    return [
        path
        for path in paths
        if not any(
            path.stem.endswith(each) and path.with_name(path.stem.removesuffix(each)) in stems
            for each in companions
        )
    ]


def open_image(path: Path, content: bytes | None = None, svg_side: int = SVG_SIDE) -> Image.Image:
    """Open an image upright, its pixels loaded; an SVG is drawn, transparent where it has nothing.

    Args:
        path: its file, or what to call it.
        content: what is in it, if it was read already.
        svg_side: longer side in pixels that an SVG is drawn with.

    Raises:
        InputError: if it is missing, no image, or of no possible size.
    """
    try:
        data = read_bounded(path, MOST_BYTES) if content is None else content
        if len(data) > MOST_BYTES:
            raise InputError(f"{path} has more than {MOST_BYTES} bytes; a drawing is smaller.")
        if b"<svg" in data[:4096]:
            data = _draw_svg(path, data, svg_side)
        with Image.open(io.BytesIO(data)) as image:
            if not SMALLEST <= min(image.size) <= max(image.size) <= LARGEST:
                is_now = f"{image.width} × {image.height} pixels"
                raise InputError(f"{path} is {is_now}; a drawing has {SMALLEST} to {LARGEST} a side.")
            image.load()
            return ImageOps.exif_transpose(image)
    except FileNotFoundError:
        raise InputError(f"there is no file {path}.") from None
    except UnidentifiedImageError:
        raise InputError(
            f"{path} is not an image that can be read; give one of {' '.join(SUFFIXES)}."
        ) from None
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path} cannot be read as an image: {brief(error)}.") from None


def _draw_svg(path: Path, data: bytes, side: int) -> bytes:
    """Return an SVG as PNG."""
    from resvg_py import svg_to_bytes  # here: few drawings are SVG

    try:
        text = data.decode("utf-8-sig")
        # Without fonts: what is drawn must not depend on those that a machine has.
        # Within a square: with a width alone, one that is very high would end the process for want of memory.
        small = bytes(svg_to_bytes(svg_string=text, width=64, height=64, dpi=_DPI, skip_system_fonts=True))
        with Image.open(io.BytesIO(small)) as image:
            wide = image.height <= image.width
        width, height = (side, None) if wide else (None, side)
        return bytes(
            svg_to_bytes(svg_string=text, width=width, height=height, dpi=_DPI, skip_system_fonts=True)
        )
    except ValueError as error:
        raise InputError(f"{path} cannot be drawn as SVG: {brief(error)}.") from None


def _brightness(image: Image.Image) -> Floats:
    """Return how bright an image of any mode is on white paper, (H, W) in [0, 1]."""
    if image.mode.startswith("I") or image.mode == "F":
        grey = np.asarray(image, dtype=np.float32)
        # 16-bit greys come as I;16, or as I with the same range; a float image has none that is agreed on.
        top = np.float32(1 if image.mode == "F" and grey.max() <= 1 else 65535)
        clipped: Floats = np.clip(grey / top, 0, 1)
        return clipped
    if image.mode in {"RGBA", "LA", "PA", "RGBa", "La"} or "transparency" in image.info:
        image = image.convert("RGBA")
        paper = Image.new("RGBA", image.size, "white")
        image = Image.alpha_composite(paper, image)
    grey = np.asarray(image.convert("RGB").convert("L"), dtype=np.float32)
    brightness: Floats = grey / np.float32(255)
    return brightness


def read_drawing(path: str | Path) -> Floats:
    """Read a drawing as ink (H, W) in [0, 1], ink 1 and paper 0; any mode, transparent is paper.

    Raises:
        InputError: if it is missing, no image, of no possible size, or holds no line.
    """
    path = Path(path)
    ink: Floats = np.float32(1) - _brightness(open_image(path))
    if ink.max() < 0.1:
        raise InputError(f"{path} is all white; a sketch needs dark lines on light paper.")
    return ink


def read_hints(path: str | Path, shape: tuple[int, int]) -> tuple[Floats, NDArray[np.bool_]]:
    """Read hints: a transparent PNG of the drawing's size with normals painted in normal-map colours.

    Returns:
        Unit normals (H, W, 3), zero where there is no hint, and where the hints are (H, W).

    Raises:
        InputError: if the picture is missing, opaque or of another size, or a colour is no normal.
    """
    path = Path(path)
    image = open_image(path)
    if (image.height, image.width) != shape:
        raise InputError(
            f"the hints {path} are {image.width} × {image.height} pixels, "
            f"but their sketch {shape[1]} × {shape[0]}."
        )
    if image.mode not in {"RGBA", "LA", "PA"} and "transparency" not in image.info:
        raise InputError(f"the hints {path} have no transparency; paint them on a transparent PNG.")
    pixels = np.asarray(image.convert("RGBA"), dtype=np.float32) / 255
    where = pixels[..., 3] > 0.5
    vectors = pixels[..., :3] * 2 - 1
    length = np.linalg.norm(vectors, axis=-1)
    wrong = np.argwhere(where & (np.abs(length - 1) > 0.25))
    if len(wrong):
        row, column = wrong[0]
        colour = np.rint(pixels[row, column, :3] * 255).astype(int).tolist()
        raise InputError(
            f"the colour {colour} at x {column}, y {row} of {path} is no normal: "
            f"(colour / 127.5 - 1) must have length 1, not {length[row, column]:.2f}."
        )
    return np.where(where[..., None], normalize(vectors), 0).astype(np.float32), where
