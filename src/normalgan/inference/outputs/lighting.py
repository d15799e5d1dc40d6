"""Lighting: shade a normal map as a clay surface."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.errors import InputError

Colour = tuple[float, float, float]

CLAY_FILE = Path(__file__).with_name("clay.json")
"""Parameters of the clay in previews; the studio's viewer reads the same file."""
_CLAY: dict[str, Any] = {
    name: tuple(value) if isinstance(value, list) else value
    for name, value in json.loads(CLAY_FILE.read_text(encoding="utf-8")).items()
}


@dataclass(frozen=True)
class Clay:
    """A matt material with a soft highlight, under one lamp and a grey sky; colours are linear, from 0 to 1.

    Args:
        colour: colour of the surface.
        lamp: colour and strength of the lamp.
        sky: light from above.
        ground: light from below.
        gloss: strength of the highlight.
        sharpness: exponent of the highlight; a larger value makes the highlight smaller.
    """

    colour: Colour = _CLAY["colour"]
    lamp: Colour = _CLAY["lamp"]
    sky: Colour = _CLAY["sky"]
    ground: Colour = _CLAY["ground"]
    gloss: float = _CLAY["gloss"]
    sharpness: float = _CLAY["sharpness"]


def lamp_direction(azimuth: float, elevation: float) -> tuple[float, float, float]:
    """Return the unit vector to a lamp (x right, y up, z to the viewer).

    Args:
        azimuth: angle around the line of sight in degrees, counter-clockwise from the right; 90 is above.
        elevation: angle above the picture plane in degrees; 90 is behind the viewer.

    >>> [round(x, 3) + 0.0 for x in lamp_direction(90, 30)]
    [0.0, 0.866, 0.5]
    """
    around, above = np.deg2rad([azimuth, elevation])
    return (
        float(np.cos(above) * np.cos(around)),
        float(np.cos(above) * np.sin(around)),
        float(np.sin(above)),
    )


def shade(normals: Floats, light: tuple[float, float, float], clay: Clay = Clay()) -> Floats:
    """Return the linear colours (..., 3) of a surface viewed from the front.

    Lambertian shading with a Blinn highlight, and hemispheric light from sky and ground.

    Args:
        normals: (..., 3), unit normals, x right, y up, z to the viewer.
        light: non-zero vector to the lamp, of any length.
        clay: the material and its lighting.

    Raises:
        InputError: if ``light`` is zero or not finite.

    References:
        Blinn 1977, "Models of Light Reflection for Computer Synthesized Pictures".

    Example:
        Surfaces that face away from the lamp only get light from sky and ground:

        >>> facing = np.array([[0, 0, 1], [1, 0, 0], [-1, 0, 0]], np.float32)
        >>> shade(facing, (1, 0, 1))[:, 1].astype(float).round(1).tolist()
        [0.4, 0.4, 0.1]
    """
    towards = np.asarray(light, np.float32)
    length = float(np.linalg.norm(towards))
    if not np.isfinite(length) or length < 1e-6:
        raise InputError(f"the light comes from {light}, which is not a direction; give a vector like 0 1 1.")
    towards = towards / length
    halfway = towards + np.array([0, 0, 1], np.float32)
    halfway /= max(float(np.linalg.norm(halfway)), 1e-6)
    lambert = np.maximum(normals @ towards, 0)[..., None]
    # The highlight fades out smoothly where the lamp does not reach.
    glint = np.maximum(normals @ halfway, 0)[..., None] ** clay.sharpness * np.minimum(4 * lambert, 1)
    up = (normals[..., 1:2] + 1) / 2
    lamp, sky, ground = (np.array(c, np.float32) for c in (clay.lamp, clay.sky, clay.ground))
    diffuse = np.array(clay.colour, np.float32) * (lambert * lamp + up * sky + (1 - up) * ground)
    lit: Floats = (diffuse + clay.gloss * glint * lamp).astype(np.float32)
    return lit


def to_srgb(linear: Floats) -> NDArray[np.uint8]:
    """Return linear colours as 8-bit sRGB (IEC 61966-2-1), clipped at white.

    >>> to_srgb(np.array([0.0, 0.2140, 1.0, 2.0], np.float32)).tolist()
    [0, 127, 255, 255]
    """
    clipped = np.clip(linear, 0, 1)
    bent = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(255 * bent), np.uint8)
