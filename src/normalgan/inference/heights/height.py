"""Height: integrate a normal map to a surface, with jumps at occluding contours."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.graphs import connected
from normalgan.inference.heights.height_pyramid import double, halve
from normalgan.inference.heights.multigrid import relax
from normalgan.inference.heights.surface import Surface
from normalgan.inference.network.tile import Tile, repeats, resize_tile
from normalgan.inference.reading.picture import fitted, resize

_SMALL = 16000
"""Maximum number of pixels that are solved without a coarser level."""
_ROUNDS, _TOLERANCE = 30, 1e-3
"""Maximum number of reweighting rounds at the coarsest level; relative energy change that ends them."""
_REFINED = 4
"""Number of reweighting rounds at a finer level."""
_LARGE, _SETTLED = 40_000, 2
"""Number of pixels above which a level is only relaxed, because the coarser level has settled the rest;
number of rounds there."""
_MOST = 1536
"""Maximum longer side that is solved; larger maps are reduced, and their heights enlarged."""


def integrate(
    normals: Floats, mask: NDArray[np.bool_], jumps: float = 2.0, tile: Tile | None = None
) -> Floats:
    """Return the height of a surface above the picture plane, by bilateral normal integration.

    A least-squares problem over all neighbouring pixels in the mask: nz ∂h/∂x + nx = 0 on each side of a
    pixel along x, and likewise along y. Where the two sides of a pixel disagree, the better fitting side gets
    more weight; weights and heights are updated alternately. This keeps the gap between a leg and the body
    behind it, and creases stay sharp.

    Args:
        normals: (H, W, 3), unit normals, x right, y up, z to the viewer. Zero vectors mark unknown normals,
            where the surface is as flat as its surroundings allow.
        mask: (H, W), True on the object; it may have holes and several parts.
        jumps: the paper's k, which controls how readily the surface breaks; 0 gives plain Poisson
            integration.
        tile: directions in which the map repeats; pixels at opposite edges are then neighbours, so that the
            heights repeat too.

    Returns:
        (H, W), height in pixels towards the viewer, with mean zero over each connected part and zero off the
        mask.

    Raises:
        InputError: if the sizes differ or a normal on the object is not finite.

    References:
        Cao, Santo, Shi, Okura, Matsushita 2022, "Bilateral Normal Integration", ECCV.

    Example:
        A plane that rises to the right by one pixel per pixel:

        >>> slope = np.broadcast_to(np.array([-1, 0, 1], np.float32) / np.sqrt(2), (2, 3, 3))
        >>> np.diff(integrate(slope, np.ones((2, 3), dtype=bool))[0]).round(3).tolist()
        [1.0, 1.0]
    """
    if normals.shape != (*mask.shape, 3):
        raise InputError(
            f"normals of shape {normals.shape} do not match a mask of {mask.shape}; "
            "they are H × W × 3 and H × W."
        )
    if not np.isfinite(normals[mask]).all():
        raise InputError("a normal on the object is not finite; heights need finite normals.")
    if max(mask.shape) > _MOST:
        return _enlarged(normals, mask, jumps, tile)
    height = np.zeros(mask.shape, np.float32)
    if mask.any():
        known = np.where(mask[..., None], normals, 0).astype(np.float64)
        height[mask] = _solved(known, mask, jumps, tile)
    return _centred(height, mask, tile)


def _centred(height: Floats, mask: NDArray[np.bool_], tile: Tile | None) -> Floats:
    """Return heights (H, W) shifted to mean zero over each connected part of a mask."""
    parts, count = _parts(mask, tile)
    means = np.zeros(count + 1, np.float32)
    means[1:] = ndimage.mean(height, parts, np.arange(1, count + 1))
    return np.where(mask, height - means[parts], 0).astype(np.float32)


def _parts(mask: NDArray[np.bool_], tile: Tile | None) -> tuple[NDArray[np.int32], int]:
    """Return the label of each pixel's connected part (H, W), from 1, and the number of parts."""
    found, count = ndimage.label(mask)  # 4-connected, like the links between heights
    parts = np.asarray(found, np.int32)
    down, across = repeats(tile)
    pairs = [np.stack([parts[-1], parts[0]])] if down else []
    pairs += [np.stack([parts[:, -1], parts[:, 0]])] if across else []
    if not pairs:
        return parts, count
    one, other = np.concatenate(pairs, 1)
    both = (one > 0) & (other > 0)
    labels = connected(count + 1, np.column_stack([one[both], other[both]]))
    # Pixels off the mask are not connected to anything and keep label 0.
    return np.asarray(labels[parts], np.int32), int(labels.max())


def _enlarged(normals: Floats, mask: NDArray[np.bool_], jumps: float, tile: Tile | None) -> Floats:
    """Return the heights of a large map, computed at a reduced size and enlarged.

    Little is lost, because the normals of a large drawing were themselves enlarged from the network's size.
    """
    shape = fitted((mask.shape[0], mask.shape[1]), _MOST)
    there = resize(mask.astype(np.float32), shape) > 0
    small = resize(np.where(mask[..., None], normals, np.float32(0)), shape)
    small /= np.maximum(np.linalg.norm(small, axis=-1, keepdims=True), 1e-6)
    height = integrate(small, there, jumps, tile) * np.float32(mask.shape[0] / shape[0])
    return _centred(resize_tile(height, (mask.shape[0], mask.shape[1]), tile), mask, tile)


def _solved(
    normals: NDArray[np.float64], mask: NDArray[np.bool_], jumps: float, tile: Tile | None
) -> NDArray[np.float64]:
    """Return the heights (n,) on the mask, solved recursively from coarse to fine.

    The breaks of the surface are found at the coarsest level, where each round is cheap and distant pixels
    are only a few steps apart.
    """
    start, rounds = None, _ROUNDS
    if jumps and np.count_nonzero(mask) > _SMALL:
        half, there = halve(normals, mask, tile)
        coarse = np.zeros(there.shape)
        coarse[there] = _solved(half, there, jumps, tile)
        start = double(coarse, normals)[mask]
        rounds = _REFINED
    surface = Surface(normals, mask, tile)
    if start is not None and len(start) > _LARGE:
        return surface.solve(jumps, _SETTLED, 0, start, relax)
    return surface.solve(jumps, rounds, _TOLERANCE, start)
