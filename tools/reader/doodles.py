"""Doodles of things from doodles.svg, with the objects that they show."""

import io
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import cv2
import numpy as np
import resvg_py
from numpy.typing import NDArray
from PIL import Image

SIDE = 480
FILE = Path(__file__).with_name("doodles.svg")
HANDS = {"straight": (1.0, 0.0), "by hand": (2.2, 4.0)}
"""The pen's width in hundredths of a doodle and the lines' deviation in pixels, by way of drawing."""
_SWING = 24
"""Sigma in pixels of the Gaussian that smooths the deviations."""
_SVG = "{http://www.w3.org/2000/svg}"
_DRAWN = "* {fill: white; stroke: black} .line {fill: none}"
_OBJECT = "* {fill: black; stroke: black} .hole {fill: white} .line {fill: none}"


def doodles(hand: str) -> Iterator[tuple[str, NDArray[np.float32], NDArray[np.bool_]]]:
    """Yield each doodle's name, page (SIDE, SIDE) in [0, 1] with ink 0, and object (SIDE, SIDE).

    Args:
        hand: one of `HANDS`.
    """
    width, stray = HANDS[hand]
    for number, group in enumerate(ElementTree.parse(FILE).getroot().iter(f"{_SVG}g")):
        shapes = "".join(ElementTree.tostring(each, encoding="unicode") for each in group)
        way = _strays(np.random.default_rng(number), stray)
        drawn, filled = (
            cv2.remap(_rendered(shapes, style, width), *way, cv2.INTER_LINEAR, borderValue=(255,))
            for style in (_DRAWN, _OBJECT)
        )
        yield group.attrib["id"], drawn.astype(np.float32) / np.float32(255), filled < 128


def _rendered(shapes: str, style: str, width: float) -> NDArray[np.uint8]:
    size = f'viewBox="-6 -6 112 112" width="{SIDE}" height="{SIDE}"'
    drawn = resvg_py.svg_to_bytes(
        svg_string=f'<svg xmlns="http://www.w3.org/2000/svg" {size}>'
        f"<style>* {{stroke-width: {width}; stroke-linejoin: round; stroke-linecap: round}} {style}</style>"
        f"{shapes}</svg>",
        background="white",
    )
    return np.asarray(Image.open(io.BytesIO(bytes(drawn))).convert("L"))


def _strays(rng: np.random.Generator, most: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the source coordinates x and y (SIDE, SIDE) of each pixel."""
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    clouds = [
        cv2.GaussianBlur(rng.normal(size=(SIDE, SIDE)).astype(np.float32), (0, 0), _SWING) for _ in "xy"
    ]
    across, down = (np.float32(most) * each / each.std() for each in clouds)
    return x + across, y + down
