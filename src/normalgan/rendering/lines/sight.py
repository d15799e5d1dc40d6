"""Where the eye was: pixel size and lines of sight, recovered from the maps alone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from normalgan.rendering.maps import Floats, Maps

Doubles = NDArray[np.float64]

_SAMPLES = 2048
_BASELINE = 120  # pairs lie this fraction of the picture apart
_FRONTAL = 0.3  # pairs seen more slantingly than this predict depth too badly to learn from
_ROUNDS = 6


@dataclass(frozen=True)
class Sight:
    """The ray of every pixel, which runs along (x, y, -1) in camera space.

    Args:
        x: (W,) slope to the right of the rays of each column; 0 under orthographic projection.
        y: (H,) slope upwards of the rays of each row; 0 under orthographic projection.
        pixel: (H, W) side of a pixel where its ray meets the surface, in units of the mesh; of no meaning
            off the object.
    """

    x: Floats
    y: Floats
    pixel: Floats


def estimate_sight(maps: Maps) -> Sight:
    """Return the rays that explain how depth changes from pixel to pixel, given the normals.

    On a surface of normal n, one pixel to the right changes the depth d by Δ. With square pixels of
    side a (orthographic) ``Δ nz = a nx``. With rays ``(c + b i, e - b j, -1)`` through column i and row j
    (perspective), ``n·P = const`` at ``P = d (x, y, -1)`` gives
    ``Δ nz = b (d nx + Δ (nx i - ny j)) + c Δ nx + e Δ ny``; one pixel up likewise, with ny for nx. Both are
    linear and fitted by least absolute residuals, so that occlusions do not count; perspective is
    believed if it explains the maps clearly better. Where depth never changes neither can be told:
    then the object is taken to span two units, as `Mesh` promises.

    Args:
        maps: with at least one pixel on the object.
    """
    height, width = maps.mask.shape
    pairs = [_pairs(maps, upwards) for upwards in (False, True)]
    design = np.concatenate([pair[0] for pair in pairs])
    target = np.concatenate([pair[1] for pair in pairs])
    flat, flat_error = _least_absolute(design[:, :1], target, np.array([_span_pixel(maps)]))
    deep, deep_error = _least_absolute(design[:, 1:], target, np.zeros(3))
    if deep[0] > 0 and deep_error < 0.8 * flat_error:
        scale, right, up = deep
        x = (right + scale * np.arange(width)).astype(np.float32)
        y = (up - scale * np.arange(height)).astype(np.float32)
        return Sight(x, y, np.where(maps.mask, maps.depth, 0) * np.float32(scale))
    side = np.float32(abs(flat[0]))
    return Sight(np.zeros(width, np.float32), np.zeros(height, np.float32), np.full_like(maps.depth, side))


def _pairs(maps: Maps, upwards: bool) -> tuple[Doubles, Doubles]:
    """Return, for a sparse grid of pixel pairs, the factors of (a, b, c, e) and the ``Δ nz`` to explain.

    The two lie some pixels apart, to average over the facets of a coarse mesh, whose interpolated normals
    are not those of the facets; what the pair says is divided by that distance.
    """
    height, width = maps.mask.shape
    apart = 1 + max(height, width) // _BASELINE
    every = 1 + int(np.sqrt(maps.mask.sum() / _SAMPLES))
    # The pair's first pixel and its second: the right one, or the one above.
    if upwards:
        first, second = np.s_[apart::every, ::every], np.s_[: height - apart : every, ::every]
    else:
        first, second = np.s_[::every, : width - apart : every], np.s_[::every, apart::every]
    normal = (maps.normal[first] + maps.normal[second]) / 2
    both = maps.mask[first] & maps.mask[second] & (normal[..., 2] > _FRONTAL)
    nx, ny, nz = normal[both].astype(np.float64).T
    near, far = (maps.depth[end][both].astype(np.float64) for end in (first, second))
    row, column = (every * index for index in np.nonzero(both))
    i = column + (0 if upwards else apart / 2)
    j = row + (apart / 2 if upwards else 0)
    step, depth = (far - near) / apart, (far + near) / 2
    slope = ny if upwards else nx
    turn = depth * slope + step * (nx * i - ny * j)
    return np.stack([slope, turn, step * nx, step * ny], axis=1), step * nz


def _least_absolute(design: Doubles, target: Doubles, prior: Doubles) -> tuple[Doubles, float]:
    """Return the coefficients of least absolute residual, by reweighted least squares, and the median.

    Directions that the design leaves open keep the value of ``prior``.
    """
    if not len(target):
        return prior, 0.0
    solution = prior
    weight = np.ones(len(target))
    scale = np.abs(target).mean() + 1e-12
    for _ in range(_ROUNDS):
        weighted = design * weight[:, None]
        # Relative to the prior, so that the shortest solution is the one nearest to it.
        rest = (target - design @ prior) * weight
        solution = prior + np.linalg.lstsq(weighted, rest, rcond=1e-9)[0]
        weight = 1 / np.sqrt(np.abs(design @ solution - target) + 1e-3 * scale)
    return solution, float(np.median(np.abs(design @ solution - target)))


def _span_pixel(maps: Maps) -> float:
    """Return the side of a pixel if the object's larger extent in the picture is two units."""
    rows, columns = np.nonzero(maps.mask)
    return float(2 / (1 + max(np.ptp(rows), np.ptp(columns))))
