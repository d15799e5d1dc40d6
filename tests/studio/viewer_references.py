"""What the studio's viewer must show, said once more in NumPy."""

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles
from normalgan.inference.outputs.lighting import shade, to_srgb
from normalgan.normals import decode, encode, paint_flat

Vector = tuple[float, float, float]


def ball(side: int, radius: float = 0.9) -> NDArray[np.uint8]:
    """Return the map (side, side, 4) of a ball, its radius in halves of the side."""
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at / radius, -at / radius)
    mask = x**2 + y**2 < 1
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1) * mask[..., None]
    colours = encode(paint_flat(normals.astype(np.float32), mask))
    return np.dstack([colours, mask * 255]).astype(np.uint8)


def lit(rgba: NDArray[np.uint8], light: Vector) -> NDArray[np.uint8]:
    """Return the lit view (H, W, 3), as `normalgan generate --preview` lights it."""
    return to_srgb(shade(decode(rgba[..., :3]), light))


def flat(rgba: NDArray[np.uint8], light: Vector) -> Doubles:
    """Return the cel view (H, W, 3): paints from dark to bright by Lambert's cosine, then a glint."""
    normals, towards = decode(rgba[..., :3]), _unit(light)
    halfway = _unit((towards[0], towards[1], towards[2] + 1))
    paint = np.broadcast_to(np.array([0.36, 0.35, 0.52]), normals.shape)
    for edge, soft, cosine, colour in (
        (0.12, 0.02, normals @ towards, (0.8, 0.6, 0.5)),
        (0.62, 0.02, normals @ towards, (0.96, 0.83, 0.66)),
        (0.988, 0.0025, normals @ halfway, (1, 0.97, 0.9)),
    ):
        much = _smoothstep(edge - soft, edge + soft, cosine)[..., None]
        paint = paint * (1 - much) + np.array(colour) * much
    return 255 * paint


def matcap(rgba: NDArray[np.uint8], light: Vector) -> NDArray[np.uint8]:
    """Return the matcap view (H, W, 3): a glazed ball that mirrors a window and a warm fill."""
    n, towards = decode(rgba[..., :3]), _unit(light)
    mirrored = 2 * n[..., 2:] * n - np.array([0, 0, 1])
    filling = _unit((-towards[0], 0.3 - towards[1], 0.35))
    wrapped = ((1 + n @ towards) / 2)[..., None] ** 2
    colour = np.array([0.012, 0.03, 0.05]) * (1 - wrapped) + np.array([0.1, 0.36, 0.38]) * wrapped
    colour += 0.75 * _smoothstep(0.86, 0.96, mirrored @ towards)[..., None] * np.array([1, 0.96, 0.88])
    colour += 0.55 * _smoothstep(0.2, 1, mirrored @ filling)[..., None] * np.array([0.5, 0.22, 0.1])
    rim = (1 - n[..., 2:]) ** 3 * (0.6 + 0.4 * n[..., 1:2])
    return to_srgb((colour + rim * np.array([0.35, 0.5, 0.6])).astype(np.float32))


def silhouette(heights: NDArray[np.float32], yaw: float, pitch: float, side: int) -> NDArray[np.bool_]:
    """Return where a relief of square heights, NaN off the object, lies on a canvas of ``side`` pixels.

    Its front turned to the right by ``yaw`` and down by ``pitch``, in radians; seen from six
    half sides away, 0.85 of the canvas large.
    """
    rows, columns = np.nonzero(np.isfinite(heights))
    length = len(heights)
    level = heights[rows, columns]
    x = (columns + 0.5) / length * 2 - 1
    y = 1 - (rows + 0.5) / length * 2
    z = (level - (level.min() + level.max()) / 2) * 2 / length
    across, towards = np.cos(yaw) * x + np.sin(yaw) * z, np.cos(yaw) * z - np.sin(yaw) * x
    up, towards = np.cos(pitch) * y - np.sin(pitch) * towards, np.sin(pitch) * y + np.cos(pitch) * towards
    enlarged = 0.85 * 6 / (6 - towards)
    at = np.floor((np.stack([-up, across]) * enlarged + 1) / 2 * side).astype(int)
    drawn = np.zeros((side, side), dtype=bool)
    drawn[at[0], at[1]] = True
    return drawn


def _unit(vector: Vector) -> Doubles:
    along: Doubles = np.array(vector) / np.linalg.norm(vector)
    return along


def _smoothstep(low: float, high: float, value: Doubles) -> Doubles:
    t = np.clip((value - low) / (high - low), 0, 1)
    smooth: Doubles = t * t * (3 - 2 * t)
    return smooth
