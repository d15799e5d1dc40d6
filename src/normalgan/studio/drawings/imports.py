"""Imports: convert an image, or the layers of a file, to PNGs for the page."""

import base64
import io
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from normalgan.decoding import Decoded, decode_frames
from normalgan.errors import InputError
from normalgan.inference.composites.animation import PAGES, count_parts, moving_kind
from normalgan.inference.composites.layers import is_plain, layered_kind, read_layers
from normalgan.inference.reading.drawings import LARGEST, SMALLEST
from normalgan.inference.reading.picture import Picture, fitted, read_picture, to_picture
from normalgan.studio.drawings.drawing_request import check_sides
from normalgan.studio.drawings.limits import LONGEST_NAME, MOST_LAYERS, MOST_SIDE

Imported = dict[str, Any]


def import_picture(content: bytes, name: str = "the picture", part: int = 1) -> Imported:
    """Return an image for the page.

    Args:
        content: a file that `normalgan.inference.reading.picture.read_picture` can read.
        name: name of the file in error messages.
        part: number of the page or frame, from 1.

    Returns:
        ``picture``, a base64 PNG with alpha; its ``width`` and ``height``; ``given``, the size in the file;
        ``layered``, whether the file has layers for `import_layers`; ``parts``, the number of pages or
        frames; ``pages``, whether they are pages; ``notes``, as in `import_layers`.

    Raises:
        InputError: if the file is not an image, is too narrow, or does not have the part.
    """
    parts = count_parts(content)
    pages = moving_kind(Path(name), content) == PAGES
    if part > parts:
        raise InputError(f"there is no {'page' if pages else 'frame'} {part} in {name}; it has {parts}.")
    if part == 1:
        picture = read_picture(Path(name), content)
    else:
        picture = to_picture(decode_frames(name, content, (SMALLEST, LARGEST)).frames[part - 1])
    given, notes = [picture.shape[1], picture.shape[0]], picture.notes.layers
    if max(picture.size) > MOST_SIDE:
        picture = picture.resized(fitted(picture.size, MOST_SIDE))
    height, width = picture.size
    check_sides("picture", height, width)
    return {
        "picture": _encoded(picture),
        "width": width,
        "height": height,
        "given": given,
        "layered": layered_kind(Path(name), content) is not None,
        "parts": parts,
        "pages": pages,
        "notes": [asdict(each) for each in notes],
    }


def import_layers(content: bytes) -> Imported:
    """Return the visible layers of a layered file's first frame, each cropped to its opaque part.

    Args:
        content: a file that `normalgan.inference.composites.layers.read_layers` can read.

    Returns:
        ``width`` and ``height`` of the drawing; ``given``, the size in the file; ``frames``, the number of
        frames; ``plain``, the names of layers of a single colour, such as paper, which are left out;
        ``notes``, the ``name`` and ``reason`` of each layer that looks different from the program that wrote
        the file; ``layers``, bottom to top, each with its ``name``, the names of its ``groups``, its
        ``opacity`` in [0, 1], its ``picture`` as base64 PNG with alpha, and its position ``x``, ``y``,
        ``width`` and ``height`` in pixels of the drawing.

    Raises:
        InputError: if the file cannot be read, is too narrow, or has no layers with lines, or too many.
    """
    name = "the file"
    found = read_layers(Path(name), content)
    shape = found.shape if max(found.shape) <= MOST_SIDE else fitted(found.shape, MOST_SIDE)
    check_sides("file", *shape)
    first = [layer for layer in found.layers if layer.frame == 0]
    plain = [layer.name for layer in first if is_plain(layer, found.shape)]
    drawn = [layer for layer in first if not is_plain(layer, found.shape)]
    if not drawn:
        raise InputError(f"{name} has no layer with lines: nothing but paper is visible in it.")
    if len(drawn) > MOST_LAYERS:
        raise InputError(
            f"{name} has {len(drawn)} visible layers; a drawing has at most {MOST_LAYERS}, "
            "so merge or hide some, or import it as one drawing."
        )
    scale = shape[1] / found.shape[1], shape[0] / found.shape[0]
    layers = []
    for layer in drawn:
        height, width = layer.pixels.shape[:2]
        picture = to_picture(Decoded(layer.pixels, (height, width)))
        inside = max(round(height * scale[1]), 1), max(round(width * scale[0]), 1)
        layers.append(
            {
                "name": " ".join(layer.name.split())[:LONGEST_NAME],
                "groups": list(layer.groups),
                "opacity": layer.opacity / 255,
                "picture": _encoded(picture.resized(inside)),
                "x": layer.left * scale[0],
                "y": layer.top * scale[1],
                "width": width * scale[0],
                "height": height * scale[1],
            }
        )
    given = [found.shape[1], found.shape[0]]
    return {
        "layers": layers,
        "plain": plain,
        "notes": [asdict(each) for each in found.notes.layers],
        "frames": len(found.durations),
        "width": shape[1],
        "height": shape[0],
        "given": given,
    }


def _encoded(picture: Picture) -> str:
    """Return a picture as base64 PNG with alpha."""
    alpha = np.ones(picture.size, np.float32) if picture.alpha is None else picture.alpha
    pixels = np.rint(255 * np.dstack([picture.colour, alpha])).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG", compress_level=1)
    return base64.b64encode(file.getvalue()).decode()
