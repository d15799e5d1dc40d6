"""Parts blended into one signed distance field on a grid, each evaluated only near itself."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from normalgan.animals.frames import Floats, Frame, Volume
from normalgan.animals.shapes import Shape, smooth_minimum

__all__ = ["FAR", "MARGIN", "Grid", "Part", "Ripple", "Window", "sample"]

FAR = np.float32(10.0)  # value of the field where no part is near
Window = tuple[slice, slice, slice]
MARGIN = 4  # grid cells round a part in which its field is right


class Ripple(NamedTuple):
    """Bumps on a surface: fleece, fur, leaves.

    Args:
        height: of the highest.
        wavelength: about the distance from one to the next.
    """

    height: float
    wavelength: float


@dataclass(frozen=True, eq=False)
class Part:
    """Shapes united sharply, which then flow into what was there before.

    Args:
        shapes: that make it up.
        blend: width of the zone in which the part and the rest flow together; 0 for a sharp seam.
        carve: take the part away instead of adding it.
        ripple: bumps on the surface, or None.
    """

    shapes: tuple[Shape, ...]
    blend: float
    carve: bool = False
    ripple: Ripple | None = None

    def reach(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner, (3,) each, of a box that holds it."""
        boxes = [shape.reach() for shape in self.shapes]
        return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)

    def placed(self, frame: Frame, size: float = 1.0) -> Self:
        """Return it scaled by ``size``, its blend too, and carried along with a frame."""
        shapes = tuple(shape.placed(frame, size) for shape in self.shapes)
        ripple = None if self.ripple is None else Ripple(*(size * length for length in self.ripple))
        return replace(self, shapes=shapes, blend=self.blend * size, ripple=ripple)


@dataclass(frozen=True, eq=False)
class Grid:
    """Where the field is sampled.

    Args:
        origin: (3,) the lowest corner.
        spacing: distance between neighbours.
        shape: number of samples along x, y, z.
    """

    origin: Floats
    spacing: float
    shape: tuple[int, int, int]

    def window(self, low: Floats, high: Floats) -> Window:
        """Return the slices of the samples in a box."""
        first = np.clip(np.floor((low - self.origin) / self.spacing), 0, self.shape).astype(int)
        last = np.clip(np.ceil((high - self.origin) / self.spacing) + 1, 0, self.shape).astype(int)
        return slice(first[0], last[0]), slice(first[1], last[1]), slice(first[2], last[2])

    def axes(self, window: Window) -> tuple[Volume, Volume, Volume]:
        """Return the open coordinate grids of a window."""
        x, y, z = (
            (self.origin[i] + self.spacing * np.arange(part.start, part.stop)).astype(np.float32)
            for i, part in enumerate(window)
        )
        return x[:, None, None], y[None, :, None], z[None, None, :]


def sample(parts: Sequence[Part], grid: Grid) -> Volume:
    """Return the signed distance, negative inside, at every sample; right near the surface, `FAR` elsewhere.

    The blend has finite width, so a part matters only within that width of its own surface.

    Returns:
        grid.shape
    """
    field = np.full(grid.shape, FAR, np.float32)
    for part in parts:
        margin = part.blend + MARGIN * grid.spacing + (part.ripple.height if part.ripple else 0.0)
        low, high = part.reach()
        window = grid.window(low - margin, high + margin)
        own = _part_field(part, grid, window, margin)
        before = field[window]
        if part.carve:
            field[window] = -smooth_minimum(-before, own, part.blend)
        else:
            field[window] = smooth_minimum(before, own, part.blend)
    return field


def _part_field(part: Part, grid: Grid, window: Window, margin: float) -> Volume:
    own = np.full([part.stop - part.start for part in window], FAR, np.float32)
    for shape in part.shapes:
        for piece in shape.pieces(grid.spacing):
            box = _overlap(grid.window(piece.low - margin, piece.high + margin), window)
            inner = _within(box, window)
            np.minimum(own[inner], piece.distance(*grid.axes(box)), out=own[inner])
    if part.ripple is not None:
        own += _ripple(grid.axes(window), part.ripple)
    return own


def _overlap(a: Window, b: Window) -> Window:
    x, y, z = (slice(max(i.start, j.start), min(i.stop, j.stop)) for i, j in zip(a, b, strict=True))
    return x, y, z


def _within(box: Window, window: Window) -> Window:
    x, y, z = (slice(a.start - b.start, a.stop - b.start) for a, b in zip(box, window, strict=True))
    return x, y, z


def _ripple(axes: tuple[Volume, Volume, Volume], ripple: Ripple) -> Volume:
    """Return bumps without a grain: plane waves in directions spread evenly over the sphere, summed.

    The directions follow the Fibonacci lattice, the wavelengths spread by half; the height is about the
    largest.
    """
    turn, count = np.pi * (3 - np.sqrt(5)), 11
    total = np.zeros([axis.size for axis in axes], np.float32)
    for i in range(count):
        up = 1 - (2 * i + 1) / count
        level = np.sqrt(1 - up * up)
        number = 2 * np.pi / ripple.wavelength * (0.8 + 0.5 * (i * 0.618 % 1))
        wave = number * np.array([level * np.cos(i * turn), up, level * np.sin(i * turn)])
        phase = sum(axis * np.float32(k) for axis, k in zip(axes, wave, strict=True))
        total += np.cos(phase + np.float32(i * i))
    scaled: Volume = total * np.float32(ripple.height / 4)
    return scaled
