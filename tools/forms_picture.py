"""Makes a picture of drawings of flat things, as predicted and in each form: forms_picture.py FILE.

The drawings come from this file: a clock, a shield, a playing card and a heart.
"""

import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan import load
from normalgan.inference.forms import parse_form
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb
from normalgan.inference.reading.picture import Picture, read_picture
from normalgan.inference.sprites import Sprite

SHAPES = (
    '<circle cx="50" cy="50" r="42"/><path d="M50 50V22M50 50L70 60M50 12v5M50 88v-5M12 50h5M88 50h-5"/>',
    '<path d="M50 8C62 16 76 18 88 16C90 52 78 78 50 92C22 78 10 52 12 16C24 18 38 16 50 8Z"/>'
    '<path d="M50 30L56 44L71 45L59 54L63 69L50 60L37 69L41 54L29 45L44 44Z"/>',
    '<rect x="22" y="8" width="56" height="84" rx="6"/>'
    '<path d="M50 32C60 44 66 48 66 56C66 64 56 66 51 59C52 66 54 69 57 71H43C46 69 48 66 49 59'
    'C44 66 34 64 34 56C34 48 40 44 50 32Z"/>',
    '<path d="M50 90C20 66 8 50 8 33C8 17 22 9 34 11C42 13 48 19 50 26C52 19 58 13 66 11C78 9 92 17 92 33'
    'C92 50 80 66 50 90Z"/><path d="M50 26C52 40 46 48 50 58"/>',
)
FORMS = (None, "flat", "flat,bevel=0.08", "hollow")
SIDE, GAP = 220, 6
PAPER = 255


def drawing(shape: str) -> Picture:
    """Return a shape as a line drawing."""
    style = 'fill="none" stroke="black" stroke-width="1.6" stroke-linejoin="round" stroke-linecap="round"'
    size = f'viewBox="-4 -4 108 108" width="{2 * SIDE}" height="{2 * SIDE}"'
    content = (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size}>'
        '<rect x="-4" y="-4" width="108" height="108" fill="white"/>'
        f"<g {style}>{shape}</g></svg>"
    )
    return read_picture(Path("shape.svg"), content.encode(), 2 * SIDE)


def lit(preds: NormalMap) -> NDArray[np.uint8]:
    """Return a map as clay under a lamp, on paper."""
    clay = to_srgb(shade(preds.extended, lamp_direction(130, 40))).astype(np.float32)
    there = preds.alpha[..., None]
    return np.asarray(np.rint(clay * there + PAPER * (1 - there)), np.uint8)


def picture() -> NDArray[np.uint8]:
    """Return a row for each drawing: the drawing, the map as predicted, and the map in each form."""
    predictor = load()
    rows = []
    for shape in SHAPES:
        drawn = drawing(shape)
        preds = predictor(drawn)
        shown = [lit(Sprite(form=None if form is None else parse_form(form))(preds, drawn)) for form in FORMS]
        row = [np.rint(255 * drawn.colour).astype(np.uint8), *shown]
        small = [cv2.resize(each, (SIDE, SIDE), interpolation=cv2.INTER_AREA) for each in row]
        rows.append(
            np.concatenate(
                [np.pad(each, ((0, GAP), (0, GAP), (0, 0)), constant_values=PAPER) for each in small], 1
            )
        )
    return np.concatenate(rows)[:-GAP, :-GAP]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: tools/forms_picture.py FILE")
    cv2.setNumThreads(1)
    target = Path(sys.argv[1])
    # WebP, like the other sheets of grey clay: the loss is invisible, and a PNG is five times as large.
    Image.fromarray(picture()).save(target, quality=80, method=6)
    print(target, f"{target.stat().st_size // 1024} kB")
