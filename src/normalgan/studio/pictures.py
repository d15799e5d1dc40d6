"""Pictures: an image of any kind, made a PNG that the page can show and send back."""

import base64
import io
from pathlib import Path

import numpy as np
from PIL import Image

from normalgan.painting.picture import fitted, read_picture
from normalgan.studio.drawing import MOST_SIDE, check_sides

__all__ = ["Imported", "import_picture"]

Imported = dict[str, str | int | list[int]]


def import_picture(content: bytes, name: str = "the picture") -> Imported:
    """Return an image as base64 of a PNG with alpha, its width and height, and those ``given``.

    Args:
        content: a file as `normalgan.painting.picture.read_picture` reads it.
        name: what to call it in an error.

    Raises:
        InputError: if it is none, or too narrow.
    """
    picture = read_picture(Path(name), content)
    given = [picture.shape[1], picture.shape[0]]
    if max(picture.size) > MOST_SIDE:
        picture = picture.resized(fitted(picture.size, MOST_SIDE))
    height, width = picture.size
    check_sides("picture", height, width)
    alpha = np.ones(picture.size, np.float32) if picture.alpha is None else picture.alpha
    pixels = np.rint(255 * np.dstack([picture.colour, alpha])).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG", compress_level=1)
    return {
        "picture": base64.b64encode(file.getvalue()).decode(),
        "width": width,
        "height": height,
        "given": given,
    }
