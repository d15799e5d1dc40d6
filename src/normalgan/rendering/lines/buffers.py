"""Buffers: high-resolution maps for finding lines, cropped to the object, and the rays of their pixels."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Doubles, Floats
from normalgan.ranges import Positive, PositiveInt
from normalgan.rendering.cameras import Camera
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

_MARGIN = 4  # pixels around the object, so that filters reach the background before the border


@dataclass(frozen=True)
class Sight:
    """The rays of the pixels, with the directions (x, y, -1) in camera space.

    Args:
        x: (W,) slopes of the rays to the right, by column; 0 for an orthographic projection.
        y: (H,) upward slopes of the rays, by row; 0 for an orthographic projection.
        pixel: (H, W) side of a pixel where the ray hits the surface, in mesh units; 0 outside the object
            for a perspective projection.
    """

    x: Floats
    y: Floats
    pixel: Floats

    def facing(self, normal: Floats) -> Floats:
        """Return n·v of each pixel (H, W), given its normal (H, W, 3); v is the unit vector to the viewer."""
        x, y = self.x[None, :], self.y[:, None]
        along = normal[..., 2] - normal[..., 0] * x - normal[..., 1] * y
        cosine: Floats = along / np.sqrt(1 + x * x + y * y)
        return cosine


@dataclass(frozen=True)
class Buffers:
    """The part of a view's maps that contains the object.

    Args:
        maps: (H, W) maps of the part.
        sight: rays of the part's pixels.
        corner: (x, y) of the part's upper left corner in the full maps.
        side: side of the full maps in pixels.
        scale: pixels of the maps per pixel of the sketch.
    """

    maps: Maps
    sight: Sight
    corner: tuple[int, int]
    side: int
    scale: int

    @classmethod
    def of(cls, view: View, resolution: int) -> Self | None:
        """Return a view's buffers, at least ``resolution`` pixels per side, or None if nothing is visible.

        The side is an integer multiple of the sketch's side.
        """
        scale = -(-resolution // view.size)
        whole = view.maps(scale)
        window = _object_window(whole.mask)
        if window is None:
            return None
        # A contiguous copy is faster, because it is read many times.
        maps = Maps(np.ascontiguousarray(whole.normal[window]), whole.depth[window], whole.mask[window])
        side = scale * view.size
        corner = (window[1].start, window[0].start)
        return cls(maps, sight(view.camera, maps, window, side), corner, side, scale)

    def to_sketch(self, points: Doubles) -> Doubles:
        """Convert points (P, 2), x right and y down, from pixels of the part to pixels of the sketch."""
        placed: Doubles = (points + np.array(self.corner)) / self.scale
        return placed


def _object_window(mask: BoolMask) -> tuple[slice, slice] | None:
    """Return the rows and columns of the object, which fills only part of the frame, with a margin."""
    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    if not width:
        return None
    rows = slice(max(top - _MARGIN, 0), min(top + height + _MARGIN, mask.shape[0]))
    return rows, slice(max(left - _MARGIN, 0), min(left + width + _MARGIN, mask.shape[1]))


def sight(camera: Camera, maps: Maps, window: tuple[slice, slice], side: int) -> Sight:
    """Return the rays of the pixels of maps (H, W), which show a window of a frame with ``side`` pixels."""
    left, right, bottom, top = camera.window
    height, width = maps.mask.shape
    pixel = np.float32((right - left) / side)
    if not camera.perspective:
        return Sight(
            np.zeros(width, np.float32), np.zeros(height, np.float32), np.full_like(maps.depth, pixel)
        )
    rows, columns = (np.arange(part.start, part.stop) + 0.5 for part in window)
    x = (left + (right - left) * columns / side).astype(np.float32)
    y = (top + (bottom - top) * rows / side).astype(np.float32)
    return Sight(x, y, np.where(maps.mask, maps.depth, 0) * pixel)


@dataclass(frozen=True)
class BufferedDrawing(LineDrawing):
    """Base class of styles that find lines in high-resolution maps of the view.

    Args:
        line_width: width of a line in pixels of the sketch, at any sketch size.
        resolution: side of the maps in pixels, rounded up to a multiple of the sketch's side. Lines have
            subpixel positions.
    """

    line_width: Positive = 1.25
    resolution: PositiveInt = 512

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        """Return the strokes; see `LineDrawing.trace`."""
        buffers = Buffers.of(view, self.resolution)
        return [] if buffers is None else self._draw(view, buffers)

    @abstractmethod
    def _draw(self, view: View, buffers: Buffers) -> list[Stroke]:
        """Return the strokes of a view, given its buffers."""
