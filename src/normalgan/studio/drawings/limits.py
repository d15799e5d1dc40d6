"""Limits of a drawing, which the server checks and passes to the page."""

import json
from html import escape

from normalgan.decoding.decoders.formats import ENDINGS
from normalgan.inference.edits import MOST_PINS, REACH
from normalgan.inference.forms import BEVELS
from normalgan.inference.structures import KINDS as STRUCTURES
from normalgan.normals import LEAST_Z

LEAST_SIDE, MOST_SIDE = 16, 2048
"""Minimum and maximum side of a drawing in pixels."""
MOST_LAYERS = 16
LONGEST_NAME = 80
"""Maximum length of a layer's name in characters."""
MOST_STROKES = 20_000
"""Maximum number of lines and pictures of a layer; only the page checks it."""
MOST_CARVED = 20_000
"""Maximum number of pieces of engraved and embossed lines; an eraser splits one line into many."""
MOST_HINTS = MOST_PINS
MOST_AREAS = 200
MOST_MASK_STROKES = 500
MOST_POINTS = 4000
"""Maximum number of points of an area."""
MOST_PICTURES = 8
"""Maximum number of pictures for tracing; only the page checks it."""
MOST_STRUCTURES = 8
"""Maximum number of pictures that serve as structures in a drawing."""
TILE_SIDE = 128
"""Side in pixels of a picture that serves as a structure."""
LEAST_PERIOD, MOST_PERIOD = 1 / 16, 2**16
"""Minimum and maximum side in pixels of a structure's tiles on a drawing."""


def with_limits(page: str) -> str:
    """Return the page with the limits inserted, as JSON in an attribute of its root and in its inputs.

    Raises:
        ValueError: if the page does not have the expected root element.
    """
    limits = {
        "sides": {"least": LEAST_SIDE, "most": MOST_SIDE},
        "layers": MOST_LAYERS,
        "name": LONGEST_NAME,
        "strokes": MOST_STROKES,
        "hints": MOST_HINTS,
        "areas": MOST_AREAS,
        "maskStrokes": MOST_MASK_STROKES,
        "points": MOST_POINTS,
        "pictures": MOST_PICTURES,
        "structures": MOST_STRUCTURES,
        "tile": TILE_SIDE,
        "periods": {"least": LEAST_PERIOD, "most": MOST_PERIOD},
        "leastZ": LEAST_Z,
        "reach": REACH,
        "forms": BEVELS,
        "kinds": STRUCTURES,
    }
    if page.count(_ROOT) != 1:
        raise ValueError(f"the page begins without {_ROOT}, where its limits go.")
    page = page.replace("data-sides", f'min="{LEAST_SIDE}" max="{MOST_SIDE}"')
    page = page.replace("data-drawings", f'accept="image/*,{",".join(ENDINGS)}"')
    return page.replace(_ROOT, f'<html lang="en" data-limits="{escape(json.dumps(limits))}">')


_ROOT = '<html lang="en">'
