"""Opening pictures without decoding them, the errors for it, and the headers of pixels."""

import io
from importlib import import_module
from typing import TYPE_CHECKING, Any

from .formats import Format, detect_format

if TYPE_CHECKING:
    from PIL.Image import Image

Message = tuple[dict[str, Any], Any]
"""A message: a dictionary of strings and numbers, and an image or array to send in strips, or None."""
MOST_PARTS, MOST_PIXELS = 1024, 2**26
"""Maximum number of frames of an animation, and of pixels in all frames (as in the largest drawing)."""
MODES: dict[str, tuple[str, tuple[int, ...]]] = {
    "L": ("uint8", ()),
    "RGB": ("uint8", (3,)),
    "RGBA": ("uint8", (4,)),
    "I;16": ("uint16", ()),
    "I": ("int32", ()),
    "F": ("float32", ()),
}
"""Pillow modes of sent pixels, with dtype and number of channels."""
DTYPES = ("uint8", "uint16", "int32", "float32")
KNOWN = "a PNG, JPEG, WebP, TIFF, GIF, SVG or another image, or a file of a paint program"
"""The supported formats in a message; the docs list all of them."""


class DamagedError(OSError):
    """Error for a damaged picture of a known format."""


class RefusedError(Exception):
    """Error for a refused file; the message follows the file's name: "is … pixels"."""


def opened(content: bytes) -> "Image":
    """Open a picture without decoding its pixels.

    Raises:
        UnidentifiedImageError: if Pillow does not know the format.
        OSError: if the picture is damaged.
    """
    from PIL import Image, UnidentifiedImageError

    Image.MAX_IMAGE_PIXELS = None  # our own limits are lower
    found = detect_format(content[:64])
    if found is None or found.plugin is None:
        raise UnidentifiedImageError
    try:
        _import_plugin(found)
    except ImportError:
        raise RefusedError(
            f"is a {found.name}; run `pip install 'normalgan[{found.name.lower()}]'` to read it, or save it "
            "as PNG or JPEG"
        ) from None
    try:
        return Image.open(io.BytesIO(content), formats=(found.plugin,))
    except UnidentifiedImageError:
        raise DamagedError(f"it starts like a {found.name} but is truncated or damaged") from None


def _import_plugin(wanted: Format) -> None:
    """Import Pillow's plug-in of a format.

    Raises:
        ImportError: if the plug-in is not installed, or Pillow was built without the codec.
    """
    plugin = import_module(wanted.modules[0])
    if wanted.plugin == "HEIF":
        plugin.register_heif_opener(thumbnails=False)
    if not getattr(plugin, "SUPPORTED", True):
        raise ImportError


def check_sides(width: int, height: int, least: int, most: int) -> None:
    """Raise `RefusedError` if a side is too short or too long."""
    if not (least <= width <= most and least <= height <= most):
        raise RefusedError(f"is {width} × {height} pixels; a drawing has {least} to {most} a side")


def reduced_size(width: int, height: int, longest: int) -> tuple[int, int]:
    """Return (width, height) of a picture downsampled to a longer side of ``longest`` pixels."""
    scale = longest / max(width, height)
    return max(round(width * scale), 1), max(round(height * scale), 1)


def with_form(pixels: Any) -> dict[str, Any]:
    """Return dtype and shape of an image or array, as the header that is sent before its pixels."""
    if hasattr(pixels, "dtype"):
        dtype, shape = pixels.dtype.name, pixels.shape
    else:
        dtype, channels = MODES[pixels.mode]
        shape = (pixels.height, pixels.width, *channels)
    return {"dtype": dtype, "shape": [*shape], "full": [*shape[:2]]}


def first_line(error: BaseException) -> str:
    """Return the first line of an error's message, or its class if it has none."""
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
