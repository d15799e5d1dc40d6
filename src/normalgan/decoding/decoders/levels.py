"""Levels: decoding of 16-bit and float pictures by OpenCV, because Pillow would round them."""

from typing import Any

from .formats import detect_format
from .opening import DTYPES, RefusedError, check_sides, first_line, reduced_size


def loses_levels(content: bytes) -> bool:
    r"""Return whether Pillow may round a picture, as for a TIFF or a colour PNG with 16 bits per channel.

    >>> loses_levels(b"II*\0 and so on"), loses_levels(b"\xff\xd8\xff a JPEG")
    (True, False)
    """
    if content.startswith(b"\x89PNG"):
        return content[24:25] == b"\x10" and content[25:26] in {b"\x02", b"\x06"}
    return is_tiff(content)


def is_tiff(content: bytes) -> bool:
    """Return whether a file is a TIFF."""
    found = detect_format(content[:64])
    return found is not None and found.name == "TIFF"


def exact_levels(content: bytes, least: int, most: int) -> Any:
    """Return the unrounded pixels, (h, w), or (h, w, 3 or 4) as red, green, blue, opacity.

    Raises:
        RefusedError: if the picture cannot be decoded.
    """
    import cv2  # only few pictures need it
    import numpy as np

    try:
        levels = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise RefusedError(f"cannot be read as an image: {first_line(error)}") from None
    if levels is None:
        raise RefusedError(
            "cannot be read as an image: it is damaged, or of an unknown format; save it as PNG"
        )
    if levels.dtype in {np.dtype(np.float64), np.dtype(np.float16)}:
        levels = levels.astype(np.float32)
    check_sides(levels.shape[1], levels.shape[0], least, most)
    if levels.ndim == 3:
        levels = levels[..., [2, 1, 0, 3][: levels.shape[2]]]
    if levels.dtype.name not in DTYPES or levels.shape[2:] not in {(), (3,), (4,)}:
        raise RefusedError(f"holds {levels.dtype.name}; levels must be 8 or 16 bits, or 32-bit floats")
    return np.ascontiguousarray(levels)


def float_white(most: float) -> float:
    """Return the value of white in a picture of floats, because no standard defines it.

    Args:
        most: maximum value of the picture. Up to 16, white is 1, as in HDR pictures; above that, white is
            255 or 65535.
    """
    return 1.0 if most <= 16 else 255.0 if most <= 255 else 65535.0


def viewed(levels: Any, longest: int, grey: bool) -> Any:
    """Return levels (h, w) or (h, w, C), downsampled and converted to grey on white as by `decode`."""
    import cv2
    import numpy as np

    if longest and max(levels.shape[:2]) > longest:
        size = reduced_size(levels.shape[1], levels.shape[0], longest)
        levels = cv2.resize(levels, size, interpolation=cv2.INTER_AREA)
    if not grey or levels.ndim == 2:
        return np.ascontiguousarray(levels)
    floats = levels.dtype == np.float32
    top = float_white(float(np.nan_to_num(levels).max())) if floats else float(np.iinfo(levels.dtype).max)
    brightness = levels[..., :3].astype(np.float32) @ np.array([0.299, 0.587, 0.114], np.float32)
    if levels.shape[2] == 4:
        opacity = levels[..., 3].astype(np.float32) / top
        brightness = brightness * opacity + top * (1 - opacity)
    return np.ascontiguousarray(brightness.astype(levels.dtype))
