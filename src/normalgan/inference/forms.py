"""Forms: make a part of a map round, flat or hollow, with a bevel of a given width."""

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Literal, cast

import cv2
import numpy as np
from annotated_types import Interval

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.regions import around, depth_of
from normalgan.inference.vectors import unit
from normalgan.normals import normalize

_Kind = Literal["round", "flat", "hollow"]
BEVELS: dict[_Kind, float] = {"round": 1.0, "flat": 0.2, "hollow": 1.0}
"""The kinds of forms, each with its default bevel."""
_STRENGTH = 0.7
"""Default strength of a form; at this strength the relief of the lines inside remains visible."""
_NUMBER = r",(bevel|strength)=(\d+\.?\d*|\.\d+)"
_TEXT = re.compile(rf"({'|'.join(BEVELS)})((?:{_NUMBER})*)")

_SIDE = 256
"""Maximum longer side in pixels at which a form is computed; it is smooth and can be enlarged afterwards."""
_COARSE = 64
"""Longer side of the coarsest level; each finer level starts from the result of the coarser one."""
_SWEEPS = 24
"""Number of sweeps at each finer level."""
_OUTSIDE = 2.0
"""Strength of the pull towards zero outside the part; partly covered pixels are pulled proportionally."""
_DISH = math.sin(math.radians(60))
"""Sine of the slope at the rim of a hollow; a vertical wall would only look like a dark line."""


@dataclass(frozen=True)
class Form:
    """The form of a part.

    Args:
        kind: "round" curves the part towards the viewer, "flat" makes it a plateau with a 45° bevel, "hollow"
            makes it a dish.
        bevel: width of the curve or the bevel as a fraction of the part's depth, above 0 and at most 1; the
            rest is level.
        strength: weight of the form against the predicted normals, from 0 to 1.
    """

    kind: _Kind
    bevel: Annotated[float, Interval(gt=0, le=1)]
    strength: Annotated[float, Interval(ge=0, le=1)]


def parse_form(text: str) -> Form:
    """Return the form of a text such as ``flat`` or ``flat,bevel=0.1,strength=1``.

    Raises:
        InputError: if the text is not a form.

    >>> parse_form("flat,bevel=0.1")
    Form(kind='flat', bevel=0.1, strength=0.7)
    """
    match = _TEXT.fullmatch(text.strip().lower())
    numbers = {name: float(value) for name, value in re.findall(_NUMBER, match[2])} if match else {}
    if match is None or not all(0 < number <= 1 for number in numbers.values()):
        raise InputError(
            f"form is {text!r}; give {', '.join(list(BEVELS)[:-1])} or {list(BEVELS)[-1]}, optionally with a "
            "bevel and a strength above 0 to 1, such as flat,bevel=0.1,strength=1."
        )
    kind = cast(_Kind, match[1])
    return Form(kind, numbers.get("bevel", BEVELS[kind]), numbers.get("strength", _STRENGTH))


def give_form(normals: Floats, mask: BoolMask, area: Floats, form: Form) -> Floats:
    """Return a map with a form applied to a part of it.

    Args:
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.
        area: (H, W) in [0, 1], coverage of each pixel by the part.
        form: form of the part.

    Example:
        A flat coin faces the viewer at its centre and slopes outwards at its rim:

        >>> y, x = np.mgrid[:64, :64] - 31.5
        >>> coin = np.hypot(x, y) < 30
        >>> dome = np.dstack([x / 31, -y / 31, np.sqrt(np.clip(1 - (x**2 + y**2) / 31**2, 0, 1))])
        >>> flat = give_form(dome.astype(np.float32), coin, coin.astype(np.float32), Form("flat", 0.2, 1))
        >>> [(flat[32, x].astype(float).round(1) + 0).tolist() for x in (32, 59)]
        [[0.0, 0.0, 1.0], [0.7, 0.0, 0.7]]
    """
    part = area * mask
    inside = part > 0.5
    if not inside.any() or form.strength == 0:
        return normals
    box = around(inside, 1)
    height, width = part[box].shape
    scale = min(_SIDE / max(height, width), 1)
    size = max(round(width * scale), 1), max(round(height * scale), 1)
    small = cv2.resize(part[box], size, interpolation=cv2.INTER_AREA) if scale < 1 else part[box]
    shaped = _shaped(np.rint(small * 255).astype(np.uint8).tobytes(), size, form.kind, form.bevel)
    if scale < 1:
        shaped = np.asarray(cv2.resize(shaped, (width, height), interpolation=cv2.INTER_LINEAR), np.float32)
    share = (form.strength * area[box])[..., None]
    formed = normals.copy()
    formed[box] = unit((1 - share) * normals[box] + share * shaped, front=True)
    return formed


def feather(area: Floats, soft: float) -> Floats:
    """Return an area (H, W) with a fade inside its edge that leaves no visible edge in the curvature.

    Args:
        area: (H, W) in [0, 1].
        soft: width of the fade as a fraction of the area's depth, above 0 and at most 1.
    """
    depth = depth_of(area > 0.5)
    width = soft * float(depth.max())
    if width <= 0:
        return area
    rise = np.clip((depth - 0.5) / width, 0, 1)
    # The first two derivatives of the ramp are zero at both ends (Perlin 2002, "Improving noise").
    faded = rise**3 * (rise * (6 * rise - 15) + 10)
    # The blur removes the crease where two sides are equally near.
    return np.asarray(cv2.GaussianBlur(faded, (0, 0), max(width / 6, 0.5)), np.float32)


@lru_cache(maxsize=32)  # while the user edits one part, the forms of all others are reused
def _shaped(part: bytes, size: tuple[int, int], kind: _Kind, bevel: float) -> Floats:
    """Return the normals (h, w, 3) of a form.

    Args:
        part: 8-bit coverage of its pixels.
        size: width and height in pixels.
        kind: kind of the form, as in `Form`.
        bevel: bevel of the form, as in `Form`.
    """
    inside = np.frombuffer(part, np.uint8).reshape(size[::-1]).astype(np.float32) / np.float32(255)
    rim = 1 + (round(0.3 * max(size) * bevel) if kind == "flat" else 0)  # reach of the blur
    inside = np.pad(inside, rim)
    depth = depth_of(inside > 0.5)
    deepest = max(float(depth.max()), 1.0)
    width = max(bevel * deepest, 1.0)
    if kind == "flat":
        off = cv2.distanceTransform((inside <= 0.5).astype(np.uint8), cv2.DIST_L2, 5)
        height = cv2.GaussianBlur(np.minimum(depth - off, width), (0, 0), max(0.15 * width, 0.7))
        down, right = np.gradient(height)
        normals = np.dstack([-right, down, np.ones_like(right)])
    else:
        # The height is the square root of the solution of a screened Poisson equation: a ball over a disc, a
        # round limb over a strip, and level farther inside than the bevel's width.
        level = 4 / width**2 - 4 / deepest**2 if width < deepest else 0.0
        square = _inflated(inside, level)
        down, right = np.gradient(square)
        normals = normalize(np.dstack([-right, down, 2 * np.sqrt(square) + np.float32(1e-3)]))
        if kind == "hollow":
            dish = np.float32(-_DISH) * normals[..., :2]
            rest = np.clip(1 - (dish**2).sum(-1), 0, 1)
            normals = np.dstack([dish, np.sqrt(rest)])
    return np.asarray(normalize(normals.astype(np.float32))[rim:-rim, rim:-rim])


def _inflated(inside: Floats, level: float) -> Floats:
    """Solve ∇²u - level u = -4 inside and u ≈ 0 outside for u (h, w), from coarse to fine."""
    height, width = inside.shape
    if max(height, width) > _COARSE:
        half = (height + 1) // 2, (width + 1) // 2
        shrunk = cv2.resize(inside, half[::-1], interpolation=cv2.INTER_AREA)
        coarse = _inflated(np.asarray(shrunk, np.float32), 4 * level)
        square = 4 * cv2.resize(coarse, (width, height), interpolation=cv2.INTER_LINEAR)
        sweeps, ahead = _SWEEPS, 1.0
    else:
        square = np.zeros_like(inside)
        # Optimal overrelaxation for a square of that side (Young 1954).
        sweeps, ahead = 2 * max(height, width), 2 / (1 + math.sin(math.pi / max(height, width)))
    y, x = np.ogrid[:height, :width]
    colours = [((x + y) % 2 == parity).astype(np.float32) for parity in (0, 1)]
    gain = np.float32(ahead) / (4 + np.float32(level) + np.float32(_OUTSIDE) * (1 - inside))
    kernel = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], np.float32)
    for _ in range(sweeps):
        for colour in colours:
            wanted = cv2.filter2D(square, -1, kernel, borderType=cv2.BORDER_CONSTANT) + 4 * inside
            square = square + colour * (wanted * gain - np.float32(ahead) * square)
    return np.asarray(np.maximum(square, 0), np.float32)
