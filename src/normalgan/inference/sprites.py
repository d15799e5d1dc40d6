"""Sprites: adapt a map to a painted sprite or to pixel art."""

from dataclasses import dataclass, replace
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.conversion import reoriented
from normalgan.inference.forms import Form, give_form
from normalgan.inference.network.tile import Tile, middle, wrapped
from normalgan.inference.normal_map import NormalMap, part_of
from normalgan.inference.reading.picture import Picture
from normalgan.inference.regions import extent_of
from normalgan.inference.tiling import give_forms
from normalgan.inference.vectors import unit
from normalgan.ranges import UnitInterval, check_ranges

T = TypeVar("T", bound=np.generic)

_COARSE = 1 / 10
"""Maximum width of shading that counts as detail, as a fraction of the object's longer side; wider shading
belongs to the form."""
_FINE = 1 / 400
"""Standard deviation of the blur against noise, as a fraction of the object's longer side."""
_DEPTH = 1 / 8
"""Height difference between black and white, as a fraction of the object's longer side."""
_LEAST_DEPTH = 6.0
"""Minimum height difference between black and white in pixels, for tiny sprites."""
_STEEPEST = 1.5
"""Limit of the slopes, so that an ink line becomes a groove instead of a cliff."""

_LARGEST_ART_PIXEL = 64
_CHANGE = 0.03
"""Minimum difference between two colours, in [0, 1]; JPEG noise is smaller."""
_ON_GRID = 0.98
"""Fraction of all colour changes that must lie on the grid of art pixels."""
_LEAST_LINES = 4
"""Minimum number of grid lines with a change; with fewer, any shape fits some grid."""
_BUSY = 0.5
"""Minimum fraction of grid lines across the drawing that have a change."""

_DARK = 0.45
"""Maximum luminance of an outline, as a fraction of the object's 75th percentile."""

_RINGS = (22.0, 45.0, 68.0)
"""Tilts in degrees of the pixel-art normals that do not face the viewer."""
_AROUND = 8


def _directions() -> Floats:
    around = np.arange(_AROUND) * (2 * np.pi / _AROUND)
    flat = np.stack([np.cos(around), np.sin(around), np.zeros(_AROUND)], 1)
    rings = [np.sin(tilt) * flat + [0, 0, np.cos(tilt)] for tilt in np.radians(_RINGS)]
    return np.concatenate([[[0, 0, 1]], *rings]).astype(np.float32)


DIRECTIONS: Floats = _directions()
"""Normals (25, 3) of a pixel-art map: one that faces the viewer, and three rings of eight."""


@dataclass(frozen=True)
class Sprite:
    """Adapts a predicted map to a sprite.

    Args:
        detail: strength of the details taken from the painting's shading, 0 to 1.
        pixel_art: whether each art pixel gets one of `DIRECTIONS`, and dark outlines the flat normal.
        form: form of the object, or of each area between the lines of a repeating drawing; None leaves it
            as predicted.
    """

    detail: UnitInterval = 0.0
    pixel_art: bool = False
    form: Form | None = None

    def __post_init__(self) -> None:
        check_ranges(self)

    @property
    def changes(self) -> bool:
        """Whether any adaptation is enabled."""
        return self.detail > 0 or self.pixel_art or self.form is not None

    def __call__(self, preds: NormalMap, picture: Picture) -> NormalMap:
        """Return the adapted map.

        Args:
            preds: the predicted map; the drawings of a sheet are adapted separately.
            picture: the drawing of the map, of any size.
        """
        if not self.changes:
            return preds
        if self.form is not None and preds.tile is not None:
            preds = give_forms(preds, picture, self.form)
        colour = picture.resized(preds.mask.shape).colour
        side = art_pixel(picture) if self.pixel_art else 1
        own_alpha = picture.alpha is not None
        if not preds.cells:
            return self._adapted(preds, colour, side, own_alpha)
        normals, mask, alpha = preds.extended.copy(), preds.mask.copy(), preds.alpha.copy()
        for cell in preds.cells:
            own = np.ascontiguousarray(cell.upright(colour[cell.box]))
            part = self._adapted(part_of(preds, cell), own, side, own_alpha)
            cell.put(normals, part.extended)
            cell.put(mask, part.mask)
            cell.put(alpha, part.alpha)
        return replace(preds, extended=normals, mask=mask, alpha=alpha)

    def _adapted(self, preds: NormalMap, colour: Floats, side: int, own_alpha: bool) -> NormalMap:
        """Return the adapted map of a single drawing with colours (H, W, 3)."""
        if not preds.mask.any():
            return preds
        if self.form is not None and preds.tile is None:
            whole = np.ones(preds.mask.shape, np.float32)
            preds = replace(preds, extended=give_form(preds.extended, preds.mask, whole, self.form))
        if not (self.detail or self.pixel_art):
            return preds
        if not self.pixel_art:
            slopes = slopes_of(colour, preds.mask, preds.tile)
            return replace(preds, extended=self._detailed(preds.extended, slopes))
        blocks = _Blocks.of(colour, side)
        opacity = blocks.mean(preds.alpha)
        there = blocks.mean(preds.mask.astype(np.float32)) >= 0.5
        weight = preds.mask.astype(np.float32)[..., None] + np.float32(1e-3)
        normals = unit(blocks.mean(preds.extended * weight), front=True)
        small = blocks.mean(colour * weight) / blocks.mean(weight)
        if self.detail:
            normals = self._detailed(normals, slopes_of(small, there, preds.tile))
        nearest = np.argmax(normals @ DIRECTIONS.T, axis=-1)
        few = DIRECTIONS[nearest]
        few[outlines(small, there)] = DIRECTIONS[0]
        # A mask found from the lines gets a hard edge, but the sprite's own opacity is kept.
        shown = opacity if own_alpha else there.astype(np.float32)
        return replace(preds, extended=blocks.back(few), mask=blocks.back(there), alpha=blocks.back(shown))

    def _detailed(self, form: Floats, slopes: Floats) -> Floats:
        """Return the form (H, W, 3) with the slopes (H, W, 2) of details added."""
        own = np.dstack([self.detail * slopes, np.ones(slopes.shape[:2], np.float32)])
        return reoriented(form, unit(np.ascontiguousarray(own, np.float32), front=True))


def slopes_of(colour: Floats, mask: BoolMask, tile: Tile | None = None) -> Floats:
    """Return the slopes (H, W, 2), nx / nz and ny / nz, of a surface whose height is the picture's luminance.

    Shading wider than a tenth of the object is left out, because the predicted form contains it.

    Args:
        colour: (H, W, 3) in [0, 1].
        mask: (H, W), the object; its colours are extended past its edge.
        tile: directions in which the painting repeats.

    Example:
        A light stripe is a ridge:

        >>> stripe = np.zeros((16, 16, 3), np.float32)
        >>> stripe[:, 7:9] = 1
        >>> slopes = slopes_of(stripe, np.ones((16, 16), bool))
        >>> bool(slopes[8, 6, 0] < -0.5), bool(slopes[8, 9, 0] > 0.5), bool(abs(slopes[..., 1]).max() < 1e-5)
        (True, True, True)
    """
    from scipy import ndimage  # here because it is slow to import

    longest = extent_of(mask)
    room = (round(3 * _COARSE * longest) + 1,) * 2
    light = _luminance(colour)
    if not mask.all():
        nearest = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
        light = light[nearest[0], nearest[1]]
    light = wrapped(light, tile, room)
    border = cv2.BORDER_REPLICATE
    fine = cv2.GaussianBlur(light, (0, 0), max(_FINE * longest, 0.5), borderType=border)
    coarse = cv2.GaussianBlur(light, (0, 0), max(_COARSE * longest, 1.5), borderType=border)
    down, right = np.gradient((fine - coarse) * np.float32(max(_DEPTH * longest, _LEAST_DEPTH)))
    slopes = middle(np.stack([-right, down], -1), tile, room)
    steepness = np.linalg.norm(slopes, axis=-1, keepdims=True)
    return np.asarray(slopes / np.sqrt(1 + (steepness / _STEEPEST) ** 2), np.float32)


def outlines(colour: Floats, mask: BoolMask) -> BoolMask:
    """Return the mask (H, W) of an object's thin dark lines: its outline and similar lines inside.

    Args:
        colour: (H, W, 3) in [0, 1], one colour per art pixel.
        mask: (H, W), the object.
    """
    light = _luminance(colour)
    dark = mask & (light < _DARK * np.percentile(light[mask], 75)) if mask.any() else mask
    solid = cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8), borderValue=0)
    thin: BoolMask = dark & (solid == 0)
    return thin


def _luminance(colour: Floats) -> Floats:
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(colour, np.float32), cv2.COLOR_RGB2GRAY), np.float32)


def art_pixel(picture: Picture) -> int:
    """Return the side of a sprite's art pixels in pixels; 1 if the sprite is not enlarged.

    If a sprite was enlarged without smoothing, all colour changes lie on a grid.

    >>> art = np.random.default_rng(0).random((16, 16, 3)).astype(np.float32)
    >>> [art_pixel(Picture(np.kron(art, np.ones((n, n, 1), np.float32)), None)) for n in (1, 3, 8)]
    [1, 3, 8]
    """
    if picture.full is not None:
        return 1  # the picture has been reduced, which destroys the grid
    seen = _seen(picture.colour, picture.alpha)
    most = min(_LARGEST_ART_PIXEL, min(picture.size) // _LEAST_LINES)
    changes = [_changes(seen, axis) for axis in (0, 1)]
    for side in range(most, 1, -1):
        if all(_offset(each, side) is not None for each in changes):
            return side
    return 1


def to_art_pixels(picture: Picture) -> Picture:
    """Return a sprite with one pixel for each art pixel; its `shape` stays that of the file.

    A sprite that was cropped within an art pixel is returned unchanged.

    >>> art = np.random.default_rng(0).random((16, 16, 3)).astype(np.float32)
    >>> small = to_art_pixels(Picture(np.kron(art, np.ones((4, 4, 1), np.float32)), None))
    >>> small.size, small.shape, bool(np.allclose(small.colour, art))
    ((16, 16), (64, 64), True)
    """
    side = art_pixel(picture)
    if side == 1:
        return picture
    blocks = _Blocks.of(picture.colour, side)
    small = len(blocks.rows), len(blocks.columns)
    if (small[0] * side, small[1] * side) != picture.size:
        return picture
    return replace(picture.resized(small), full=picture.size, notes=picture.notes)


def _seen(colour: Floats, alpha: Floats | None) -> Floats:
    return colour if alpha is None else np.dstack([colour * alpha[..., None], alpha])


def _changes(colour: Floats, axis: int) -> Floats:
    """Return the total colour change before each row (axis 0) or column (axis 1); 0 before the first."""
    difference = np.abs(np.diff(colour, axis=axis)).max(-1)
    total = np.where(difference > _CHANGE, difference, 0).sum(1 - axis)
    return np.concatenate([[0], total]).astype(np.float32)


def _offset(changes: Floats, side: int) -> int | None:
    """Return the offset of the grid on which the changes lie; None if they lie on no grid."""
    by_offset = _by_offset(changes, side)
    offset = int(by_offset.argmax())
    if by_offset[offset] < _ON_GRID * max(float(by_offset.sum()), 1e-6):
        return None
    lines = np.flatnonzero(changes[offset::side])
    if len(lines) < _LEAST_LINES or len(lines) < _BUSY * (np.ptp(lines) + 1):
        return None
    return offset


def _by_offset(changes: Floats, side: int) -> Floats:
    """Return the changes (N,) summed over the grid lines for each offset, (side,)."""
    summed: Floats = np.pad(changes, (0, -len(changes) % side)).reshape(-1, side).sum(0)
    return summed


@dataclass(frozen=True)
class _Blocks:
    """The art pixels of a picture; those at the picture's edges may be cropped.

    Args:
        rows: first pixel row of each row of art pixels.
        columns: first pixel column of each column of art pixels.
        shape: (H, W) of the picture.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    shape: tuple[int, int]

    @classmethod
    def of(cls, colour: Floats, side: int) -> "_Blocks":
        """Return the art pixels with this side that fit the changes of the colours (H, W, 3) best."""
        starts = []
        for axis in (0, 1):
            offset = int(_by_offset(_changes(colour, axis), side).argmax())
            starts.append(np.unique([0, *range(offset, colour.shape[axis], side)]))
        return cls(starts[0], starts[1], (colour.shape[0], colour.shape[1]))

    def mean(self, picture: Floats) -> Floats:
        """Return a picture (H, W) or (H, W, C) averaged over each art pixel."""
        total = np.add.reduceat(np.add.reduceat(picture, self.rows, axis=0), self.columns, axis=1)
        count = np.multiply.outer(*self._sides()).astype(np.float32)
        return np.asarray(total / (count if picture.ndim == 2 else count[..., None]), np.float32)

    def back(self, blocks: NDArray[T]) -> NDArray[T]:
        """Return a picture in which each pixel has the value of its art pixel."""
        rows, columns = self._sides()
        return np.repeat(np.repeat(blocks, rows, axis=0), columns, axis=1)

    def _sides(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        return np.diff(self.rows, append=self.shape[0]), np.diff(self.columns, append=self.shape[1])
