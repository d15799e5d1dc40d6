"""Structures: add a repeating relief, such as scales or fur, to the surface of a map."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.conversion import reoriented
from normalgan.inference.unrolling import unroll
from normalgan.normals import normalize

Kind = Literal["scales", "fur", "weave", "stone", "bark"]
KINDS: tuple[Kind, ...] = get_args(Kind)

FILE = "structure_{}.bin"
"""File name under which the page loads a built-in structure."""
_SIDE = 256
"""Side of a tile in pixels."""
_STEEP = 0.6
"""Root mean square of a tile's slopes at full strength; 0.6 is about 31°."""
_EVEN = 1e-4
"""Root mean square of the slopes, for heights from 0 to 1, below which a picture counts as flat."""
_DEEPEST = 65535


@dataclass(frozen=True)
class Placement:
    """The position, size and rotation of a structure's tiles on a map.

    Args:
        period: side of a tile in pixels, greater than 0.
        turn: clockwise rotation of the tiles about the corner (x, y), in radians.
        x: column of the corner in pixels.
        y: row of the corner in pixels.
        flipped: whether the tiles are mirrored horizontally before they are rotated.
    """

    period: float
    turn: float = 0
    x: float = 0
    y: float = 0
    flipped: bool = False


@dataclass(frozen=True)
class Tile:
    """The slopes of a tile, to the right and down, as a mipmap pyramid.

    Args:
        levels: (S, S, 2), (S/2, S/2, 2), …, slopes in pixels per pixel; each level averages the previous one.
    """

    levels: tuple[Floats, ...]

    @classmethod
    def of(cls, heights: Floats) -> "Tile":
        """Return the tile of heights (S, S) in any unit; a side of 2 ** n has n + 1 levels."""
        slopes = _slopes(heights)
        steepness = float(np.sqrt((slopes**2).sum(-1).mean()))
        levels = [slopes * np.float32(_STEEP / steepness if steepness > _EVEN * np.ptp(heights) > 0 else 0)]
        while len(levels[-1]) % 2 == 0:
            half = len(levels[-1]) // 2
            means = levels[-1].reshape(half, 2, half, 2, 2).mean((1, 3))
            levels.append(np.asarray(means, np.float32))
        return cls(tuple(levels))


def impress(
    normals: Floats,
    mask: BoolMask,
    area: Floats,
    tile: Tile,
    placement: Placement,
    unrolled: Floats | None = None,
) -> Floats:
    """Return a map with a structure added to its surface, in proportion to the coverage.

    Args:
        normals: (H, W, 3), unit normals.
        mask: (H, W), the object.
        area: (H, W) in [0, 1], coverage of each pixel by the structure.
        tile: the structure.
        placement: placement of the tiles.
        unrolled: (H, W, 2), unrolled surface on which the tiles lie, from `unroll`; None unrolls the map.

    Example:
        >>> flat = np.zeros((64, 64, 3), np.float32)
        >>> flat[..., 2] = 1
        >>> whole = np.ones((64, 64), np.float32)
        >>> rough = impress(flat, whole > 0, whole, read_tile("weave"), Placement(32))
        >>> bool(np.allclose(rough[:32, :32], rough[32:, 32:], atol=1e-5)), bool(rough[..., 2].min() < 0.96)
        (True, True)
    """
    from scipy import ndimage  # here because it is slow to import

    rows, columns = np.nonzero((area > 1e-3) & mask)
    if not rows.size:
        return normals
    finest = len(tile.levels[0])
    level = min(max(round(float(np.log2(finest / placement.period))), 0), len(tile.levels) - 1)
    slopes = tile.levels[level]
    cos, sin = np.cos(placement.turn), np.sin(placement.turn)
    across = -1 if placement.flipped else 1
    moved = (unroll(normals, mask) if unrolled is None else unrolled)[rows, columns]
    x, y = columns + 0.5 - placement.x + moved[:, 0], rows + 0.5 - placement.y + moved[:, 1]
    side = len(slopes) / placement.period
    # Pixel centres lie half a pixel from the corner of a tile.
    places = (cos * y - sin * x) * side - 0.5, across * (cos * x + sin * y) * side - 0.5
    right, down = (
        ndimage.map_coordinates(channel, places, np.float64, order=1, mode="grid-wrap")
        for channel in np.moveaxis(slopes, -1, 0)
    )
    share = area[rows, columns]
    leaning = np.stack(
        [
            -(cos * across * right - sin * down) * share,
            (sin * across * right + cos * down) * share,
            np.ones(rows.size),
        ],
        axis=-1,
    )
    impressed = normals.copy()
    detail = normalize(leaning.astype(np.float32))
    impressed[rows, columns] = reoriented(normals[rows, columns][None], detail[None])[0]
    return impressed


@lru_cache(maxsize=len(KINDS))
def read_tile(kind: Kind) -> Tile:
    """Return a built-in structure."""
    return Tile.of(np.frombuffer(tile_bytes(kind), "<u2").reshape(_SIDE, _SIDE).astype(np.float32))


@lru_cache(maxsize=len(KINDS))
def tile_bytes(kind: Kind) -> bytes:
    """Return the heights of a built-in structure for the page, as rows of little-endian 16-bit integers."""
    heights = make_heights(kind)
    levels = np.rint(_DEEPEST * (heights - heights.min()) / np.ptp(heights))
    return bytes(levels.astype("<u2").data)


def make_heights(kind: Kind) -> NDArray[np.float64]:
    """Return the heights (S, S) of a built-in structure, which repeat seamlessly."""
    makers = {"scales": _scales, "fur": _fur, "weave": _weave, "stone": _stone, "bark": _bark}
    return makers[kind](np.random.default_rng(KINDS.index(kind)))


def _slopes(heights: Floats) -> Floats:
    """Return the slopes (S, S, 2) of a tile, to the right and down."""
    right = np.roll(heights, -1, 1) - np.roll(heights, 1, 1)
    down = np.roll(heights, -1, 0) - np.roll(heights, 1, 0)
    return np.asarray(np.stack([right, down], axis=-1) / 2, np.float32)


def _grid() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y (S, S) of a tile's pixel centres, from 0 to 1."""
    y, x = (np.mgrid[:_SIDE, :_SIDE] + 0.5) / _SIDE
    return x, y


def _wrapped(offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the offset to the nearest repeat, from -0.5 to 0.5."""
    return offset - np.rint(offset)


def _noise(
    rng: np.random.Generator, fall: float, stretch: float = 1, coarsest: float = 1
) -> NDArray[np.float64]:
    """Return seamless noise (S, S) with mean 0 and standard deviation 1.

    Args:
        rng: random generator.
        fall: exponent of the fall-off of amplitudes with frequency.
        stretch: vertical stretch of the features.
        coarsest: lowest frequency in cycles per tile.
    """
    waves = np.fft.fftfreq(_SIDE, 1 / _SIDE)
    frequency = np.hypot(waves[:, None] * stretch, waves[None])
    share = np.where(frequency >= coarsest, np.maximum(frequency, 1) ** -fall, 0)
    values = np.fft.ifft2(np.fft.fft2(rng.standard_normal((_SIDE, _SIDE))) * share).real
    return np.asarray(values / values.std())


def _scales(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return rows of overlapping scales."""
    x, y = _grid()
    columns, rows = 4, 8
    field = np.zeros_like(x)
    for row in range(rows):
        for column in range(columns):
            middle = (column + (row % 2) / 2 + 0.25) / columns
            size = 1 + 0.05 * rng.standard_normal()
            across = _wrapped(x - middle) * columns / (0.64 * size)
            along = _wrapped(y - (row + 0.5) / rows) * columns / (0.68 * size)
            # The free end of a scale is a pointed arch.
            away = np.hypot(across, along) + 0.12 * np.abs(across) * np.clip(along, 0, None)
            edge = np.clip((1 - away) / 0.16, 0, 1)
            rim = 1 - (1 - edge) ** 2
            dome = 0.55 + 0.45 * along - 0.35 * across**2
            keel = 0.12 * np.exp(-((across / 0.1) ** 2)) * np.clip(0.75 - along, 0, 1)
            rings = 0.018 * np.cos(2 * np.pi * away * 5) * np.clip(along + 0.6, 0, 1)
            np.maximum(field, rim * (dome + keel + rings), out=field)
    return field


def _fur(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return hairs that point down, in locks."""
    field = np.zeros((_SIDE, _SIDE))
    lean, lift = _noise(rng, 2.2), _noise(rng, 1.8)
    for _ in range(1500):
        left, top = rng.integers(0, _SIDE, 2)
        length = rng.uniform(0.2, 0.4) * _SIDE
        side = 0.16 * lean[top, left] + rng.normal(0, 0.06)
        bend = 0.08 * rng.standard_normal() - 0.5 * side
        width = rng.uniform(3, 5)
        along = np.arange(int(length)) / length
        middle = left + length * (side * along + bend * along**2)
        taper = np.sqrt(np.clip(1 - along, 0, 1)) * np.sqrt(np.clip(6 * along, 0, 1))
        around = np.arange(-6, 7)
        columns = np.floor(middle)[:, None].astype(int) + around
        off = np.abs(columns + 0.5 - middle[:, None]) / np.maximum(width * taper, 0.6)[:, None]
        hair = 1.4 * np.sqrt(np.clip(1 - off**2, 0, None)) * (0.3 + taper)[:, None]
        base = 2 + 0.7 * lift[top, left] + rng.uniform(0, 0.9)
        rise = np.sin(np.pi * (0.12 + 0.7 * along))[:, None]
        heights = (base * rise + hair) * (off < 1)
        rows = (top + np.arange(len(along)))[:, None] % _SIDE
        place = np.broadcast_to(rows, columns.shape), columns % _SIDE
        np.maximum.at(field, place, heights)
    return field


def _weave(_: np.random.Generator) -> NDArray[np.float64]:
    """Return a plain weave."""
    x, y = _grid()
    threads = 8
    field = np.full_like(x, -2.0)
    for along, across in ((y, x), (x, y)):
        number = np.floor(across * threads)
        off = 2 * (across * threads - number) - 1
        # Where these threads pass under, the crossing ones pass over.
        turned = number + (0 if along is y else 1)
        over = np.tanh(1.5 * np.cos(np.pi * (along * threads - 0.5)) * np.where(turned % 2, -1, 1))
        round_ = np.sqrt(np.clip(1 - (off / 0.84) ** 2, 0, 1))
        fibres = 0.06 * np.cos(2 * np.pi * (along * threads * 3 + (0.8 if along is y else -0.8) * off))
        thread = 0.55 * over + (0.75 + fibres) * round_
        np.maximum(field, np.where(round_ > 0, thread, -2.0), out=field)
    return np.asarray(np.clip(field, -0.35, None))


def _cells(
    rng: np.random.Generator, count: int, x: NDArray[np.float64], y: NDArray[np.float64], stretch: float = 1
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the distance of each pixel from its Voronoi cell's border, in cell sizes, and the cell's index.

    Args:
        rng: random generator.
        count: number of cells.
        x: (S, S), x of each pixel from 0 to 1.
        y: (S, S), y of each pixel from 0 to 1.
        stretch: vertical stretch of the cells.
    """
    points = rng.uniform(size=(count, 2))

    def away() -> NDArray[np.float64]:
        offsets = [_wrapped(each - points[:, k, None, None]) for k, each in ((0, x), (1, y))]
        return np.hypot(offsets[0], offsets[1] / stretch)

    for _ in range(4):  # evens out the cells (Lloyd 1982)
        nearest = away().argmin(0)
        for k in range(count):
            inside = nearest == k
            if inside.any():
                for axis, each in ((0, x), (1, y)):
                    points[k, axis] += _wrapped(each[inside] - points[k, axis]).mean()
    distance = away()
    first, second = np.partition(distance, 1, axis=0)[:2]
    return (second - first) * np.sqrt(count / stretch), distance.argmin(0)


def _stone(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a wall of rounded stones with rough faces and mortar joints."""
    x, y = _grid()
    bent = [each + 0.012 * _noise(rng, 2) for each in (x, y)]
    border, number = _cells(rng, 22, bent[0], bent[1])
    rise = np.clip((border - 0.07) / 0.55, 0, 1)
    stone = np.sqrt(1 - (1 - rise) ** 2)
    tall = rng.uniform(0.75, 1.1, 22)[number]
    rough = 0.035 * _noise(rng, 1.4, coarsest=4) + 0.03 * _noise(rng, 2)
    mortar = 0.03 * _noise(rng, 1, coarsest=6) * (rise == 0)
    return np.asarray(stone * tall + rough * np.minimum(3 * rise, 1) + mortar)


def _bark(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return vertical plates of bark with furrows between them."""
    x, y = _grid()
    across, along = x + 0.018 * _noise(rng, 2, stretch=0.7), y + 0.03 * _noise(rng, 2)
    border, number = _cells(rng, 18, across, along, stretch=3.5)
    rise = np.clip((border - 0.06) / 0.5, 0, 1)
    plate = (1 - (1 - rise) ** 2) * rng.uniform(0.8, 1.1, 18)[number]
    grain = 1 - np.abs(_noise(rng, 1.6, stretch=5, coarsest=4))
    cracks = _noise(rng, 1.7, stretch=0.6, coarsest=6)
    return np.asarray(plate + (0.12 * grain + 0.02 * cracks) * (0.4 + rise))
