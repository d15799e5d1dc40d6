"""Preview: render a normal map under a circling lamp, as a contact sheet or an animation."""

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap, as_it_lies
from normalgan.inference.outputs.base import OUTPUTS, Output
from normalgan.inference.outputs.engines import Engine
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb
from normalgan.inference.reading.picture import fitted_within, resize
from normalgan.normals import normalize

Pixels = NDArray[np.uint8]
Opacity = NDArray[np.bool_] | Floats

_PAPER = (0.020, 0.022, 0.026)  # linear; darker than shadows on the clay
_GAP = 2  # pixels between the pictures of a sheet
_SIDE = 1024  # longest side of a picture in pixels; 36 pictures of the largest maps would fill the memory
_FINE = 4  # supersampling factor of the ball, for a smooth edge


@OUTPUTS.register
@dataclass(frozen=True)
class Preview(Output):
    """The map, lit by a lamp that circles it, at up to 1024 pixels.

    Args:
        format: png shows eight directions of light side by side, gif is an animation.
    """

    name: ClassVar[str] = "preview"
    label: ClassVar[str] = "Lit preview"
    in_zip: ClassVar[bool] = False  # which holds one picture, under the user's own lights
    engine_suffixes: ClassVar[Mapping[Engine, str]] = {"unity": "_Preview", "unreal": "_Preview"}

    format: Literal["png", "gif"] = "png"

    def encode(self, preds: NormalMap) -> dict[str, bytes]:
        """Return the content of the file."""
        turning = preview_png if self.format == "png" else preview_gif
        return {self.endings[0]: turning(*_reduced(as_it_lies(preds), preds.mask))}


def _reduced(normals: Floats, mask: BoolMask) -> tuple[Floats, Opacity]:
    """Return a map and its mask, reduced if they are large."""
    size = fitted_within(mask.shape, _SIDE)
    if size == mask.shape:
        return normals, mask
    return resize(normals, size), resize(mask.astype(np.float32), size)


def lit(normals: Floats, opacity: Opacity, azimuth: float, elevation: float = 25.0) -> Pixels:
    """Return a map rendered as clay, (H, W, 3) sRGB, with a small ball under the same lamp in the corner.

    Args:
        normals: (H, W, 3), unit normals, x right, y up, z to the viewer.
        opacity: (H, W), bool or in [0, 1], 1 on the object.
        azimuth: azimuth of the lamp in degrees, counter-clockwise from the right; 90 is above.
        elevation: elevation of the lamp in degrees; 90 is behind the viewer.

    Raises:
        InputError: if the sizes differ.
    """
    if normals.shape != (*opacity.shape, 3):
        raise InputError(
            f"a map of shape {normals.shape} does not match an opacity of {opacity.shape}; "
            "they are H × W × 3 and H × W."
        )
    light = lamp_direction(azimuth, elevation)
    surface, cover = _soften(normalize(normals), opacity)
    picture = shade(surface, light) * cover + np.array(_PAPER, np.float32) * (1 - cover)
    side = max(min(opacity.shape) // 8, 8)
    height, width = opacity.shape
    if side + 4 <= min(height, width):
        margin = side // 4
        rows = slice(height - margin - side, height - margin)
        columns = slice(width - margin - side, width - margin)
        picture[rows, columns] = _ball(side, light, picture[rows, columns])
    return to_srgb(picture)


def turn(normals: Floats, opacity: Opacity, frames: int) -> list[Pixels]:
    """Return renderings of a map while the lamp circles it once, clockwise from the upper left.

    Args:
        normals: (H, W, 3) unit normals.
        opacity: (H, W), 1 on the object.
        frames: number of pictures.

    Raises:
        InputError: if there are no frames.
    """
    if frames < 1:
        raise InputError(f"a preview needs at least one frame, not {frames}.")
    return [lit(normals, opacity, 135 - 360 * i / frames) for i in range(frames)]


def sheet(pictures: list[Pixels], columns: int = 4) -> Pixels:
    """Return pictures of the same size in a grid, row by row, with `_GAP` pixels between them.

    >>> sheet([np.zeros((4, 6, 3), np.uint8)] * 3, columns=2).shape
    (10, 14, 3)
    """
    height, width = pictures[0].shape[:2]
    columns = min(columns, len(pictures))
    rows = -(-len(pictures) // columns)
    whole = np.empty((rows * (height + _GAP) - _GAP, columns * (width + _GAP) - _GAP, 3), np.uint8)
    whole[:] = to_srgb(np.array(_PAPER, np.float32))
    for i, picture in enumerate(pictures):
        top, left = i // columns * (height + _GAP), i % columns * (width + _GAP)
        whole[top : top + height, left : left + width] = picture
    return whole


def preview_png(normals: Floats, opacity: Opacity, frames: int = 8) -> bytes:
    """Return a PNG of the map under ``frames`` directions of light; the result is deterministic."""
    file = BytesIO()
    Image.fromarray(sheet(turn(normals, opacity, frames))).save(file, "PNG", optimize=True)
    return file.getvalue()


def preview_gif(normals: Floats, opacity: Opacity, frames: int = 36, seconds: float = 3.0) -> bytes:
    """Return a looping GIF in which the lamp circles the map; the result is deterministic.

    Args:
        normals: (H, W, 3) unit normals.
        opacity: (H, W), 1 on the object.
        frames: number of pictures.
        seconds: duration of one circle.
    """
    pictures = turn(normals, opacity, frames)
    # All frames share one palette; with a palette per frame, the tones would flicker.
    palette = Image.fromarray(sheet(pictures[:: max(frames // 12, 1)])).quantize(
        256, Image.Quantize.MEDIANCUT
    )
    first, *rest = (Image.fromarray(p).quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures)
    file = BytesIO()
    # GIF durations are multiples of 1/100 s.
    delay = max(round(100 * seconds / frames), 2) * 10
    first.save(file, "GIF", save_all=True, append_images=rest, duration=delay, loop=0, disposal=1)
    return file.getvalue()


def _soften(normals: Floats, opacity: Opacity) -> tuple[Floats, Floats]:
    """Return normals extended past the outline, and the coverage of each pixel (H, W, 1).

    A binary outline is a staircase of pixels, so it is blurred by less than a pixel.
    """
    there = opacity.astype(np.bool_)
    if opacity.dtype != np.bool_:
        return normals, opacity.astype(np.float32)[..., None]
    if not there.any():
        return normals, np.zeros((*there.shape, 1), np.float32)
    from scipy import ndimage  # here because it is slow to import

    nearest = ndimage.distance_transform_edt(~there, return_distances=False, return_indices=True)
    cover = ndimage.gaussian_filter(there.astype(np.float32), 0.8, truncate=2.5)
    return normals[nearest[0], nearest[1]], np.clip(2 * cover - 0.5, 0, 1)[..., None]


def _ball(side: int, light: tuple[float, float, float], behind: Floats) -> Floats:
    """Return a shaded ball in a square of ``side`` pixels, composited over a background."""
    along = (np.arange(side * _FINE) + 0.5) / (side * _FINE) * 2 - 1
    x, y = np.meshgrid(along, -along)
    depth = 1 - x**2 - y**2
    normals = np.stack([x, y, np.sqrt(np.maximum(depth, 0))], axis=-1).astype(np.float32)
    inside = (depth > 0).astype(np.float32)
    squares = (side, _FINE, side, _FINE)
    cover = inside.reshape(squares).mean((1, 3))
    colours = (shade(normals, light) * inside[..., None]).reshape(*squares, 3).mean((1, 3))
    return np.asarray(colours + behind * (1 - cover[..., None]), np.float32)
