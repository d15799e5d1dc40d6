"""Parts blended into one signed distance field on a grid, each evaluated only near itself."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from normalgan.animals.solids import Solid
from normalgan.animals.sweep import Floats, Sweep, Volume, reach, segment_distance

__all__ = ["FAR", "MARGIN", "Grid", "Part", "Ripple", "Window", "sample", "smooth_minimum"]

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
    """Sweeps and solids united sharply, which then flow into what was there before.

    Args:
        sweeps: the tubes.
        blend: width of the zone in which the part and the rest flow together; 0 for a sharp seam.
        carve: take the part away instead of adding it.
        ripple: bumps on the surface, or None.
        solids: ellipsoids, boxes, rings, plates.
    """

    sweeps: tuple[Sweep, ...]
    blend: float
    carve: bool = False
    ripple: Ripple | None = None
    solids: tuple[Solid, ...] = ()

    def reach(self) -> tuple[Floats, Floats]:
        """Return the lowest and highest corner, (3,) each, of a box that holds it."""
        boxes = [reach(sweep) for sweep in self.sweeps] + [solid.reach() for solid in self.solids]
        return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


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


def smooth_minimum(a: Volume, b: Volume, width: float) -> Volume:
    """Return min(a, b), rounded where they differ by less than ``width`` (Quilez, cubic polynomial).

    >>> float(smooth_minimum(np.float32([1]), np.float32([3]), 1.0)[0])
    1.0
    """
    if width <= 0:
        return np.minimum(a, b)
    near = np.maximum(np.float32(width) - np.abs(a - b), 0) / np.float32(width)
    rounded: Volume = np.minimum(a, b) - near * near * near * np.float32(width / 6)
    return rounded


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
    for sweep in part.sweeps:
        fat = np.maximum(sweep.radii, sweep.widths)
        for i in range(len(sweep.points) - 1):
            pad = max(fat[i], fat[i + 1]) + margin
            ends = sweep.points[i : i + 2]
            near = grid.window(ends.min(axis=0) - pad, ends.max(axis=0) + pad)
            box = _overlap(near, window)
            x, y, z = grid.axes(box)
            distance = segment_distance(sweep, i, x, y, z)
            if sweep.cut is not None and 3 * i >= 2 * len(sweep.points):
                point, normal = sweep.cut
                plane = (x - point[0]) * normal[0] + (y - point[1]) * normal[1] + (z - point[2]) * normal[2]
                distance = -smooth_minimum(-distance, -plane.astype(np.float32), 1.5 * grid.spacing)
            inner = _within(box, window)
            np.minimum(own[inner], distance, out=own[inner])
    for solid in part.solids:
        low, high = solid.reach()
        box = _overlap(grid.window(low - margin, high + margin), window)
        inner = _within(box, window)
        np.minimum(own[inner], solid.distance(*grid.axes(box)), out=own[inner])
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
