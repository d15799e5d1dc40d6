"""Test hints: uniform hints, other placements, and inaccurate hints."""

from collections.abc import Callable, Sequence

import numpy as np
import torch
from torch import Tensor

from normalgan.arrays import BoolMask, Doubles, Indices
from normalgan.hints import CurvatureHints, FarthestPointHints, HintSampler, UniformHints, WorstErrorHints
from normalgan.seeds import derive_seed

_SAMPLERS: dict[str, Callable[[int], HintSampler]] = {
    "uniform": lambda count: UniformHints(count, count),
    "curvature": lambda count: CurvatureHints(count=count),
    "farthest": FarthestPointHints,
    "worst": WorstErrorHints,
}
"""Placements by name: uniform on the object; by the paper's sampler; far from each other; where a method is
most wrong without hints, which only an oracle knows."""
_TRIES = 16  # number of directions tried before a hint is not moved


def hint_order(mask: Tensor, name: str, seed: int, most: int) -> Tensor:
    """Return the flat indices of a sample's hinted pixels, in the order in which hints are added.

    The first five of fifty hints are the same as five hints.

    Args:
        mask: (1, H, W), 1 on the object.
        name: name of the sample, which determines the points.
        seed: seed of the points.
        most: number of hints; there are fewer if the object has fewer pixels.
    """
    pixels = torch.nonzero(mask.flatten() > 0.5).flatten()
    order = np.random.default_rng(derive_seed("benchmark", seed, name)).permutation(len(pixels))
    return pixels[torch.from_numpy(order[:most]).to(pixels.device)]


def hint_points(mask: Tensor, names: Sequence[str], seed: int, count: int) -> Tensor:
    """Return the hint mask (N, 1, H, W) of a batch, 1 at a hint, in the mask's type.

    Args:
        mask: (N, 1, H, W), 1 on the object.
        names: names of the N samples.
        seed: seed of the points.
        count: number of hints per sample; fewer if the object has fewer pixels.
    """
    where = torch.zeros_like(mask)
    for sample, one, name in zip(where, mask, names, strict=True):
        sample.view(-1)[hint_order(one, name, seed, count)] = 1
    return where


def placements(names: Sequence[str], counts: Sequence[int]) -> dict[str, HintSampler]:
    """Return a sampler for each `Placement` and number of hints, by the name of its figures.

    >>> list(placements(["uniform", "worst"], [3, 10]))
    ['uniform-3', 'uniform-10', 'worst-3', 'worst-10']
    """
    return {f"{name}-{count}": _SAMPLERS[name](count) for name in names for count in counts}


def noisy_hints(
    normal: Tensor,
    mask: Tensor,
    where: Tensor,
    names: Sequence[str],
    seed: int,
    degrees: float,
    pixels: float,
) -> Tensor:
    """Return hints (N, 4, H, W), each rotated by an angle and moved by a distance in a random direction.

    Every hint is rotated by exactly ``degrees``, never away from the viewer, and moved by ``pixels``,
    rounded. It is not moved if it would leave the object.

    Args:
        normal: (N, 3, H, W), true unit normals.
        mask: (N, 1, H, W), 1 on the object.
        where: (N, 1, H, W), 1 at the hints without noise.
        names: names of the samples.
        seed: seed of the directions.
        degrees: angle of each rotation.
        pixels: distance of each shift.
    """
    hints = torch.zeros(len(normal), 4, *normal.shape[2:], dtype=normal.dtype)
    for i, name in enumerate(names):
        rng = np.random.default_rng(derive_seed("hint noise", seed, name))
        inside = mask[i, 0].cpu().numpy() > 0.5
        points = np.argwhere(where[i, 0].cpu().numpy() > 0.5)
        true = normal[i].cpu().double().numpy()[:, points[:, 0], points[:, 1]].T
        turned = turn(true, degrees, rng.uniform(0, 2 * np.pi, len(points)))
        for vector, point in zip(turned, points, strict=True):
            row, column = _moved(point, pixels, inside, rng)
            hints[i, :3, row, column] = torch.from_numpy(vector).to(hints)
            hints[i, 3, row, column] = 1
    return hints.to(normal.device)


def turn(normals: Doubles, degrees: float, azimuths: Doubles) -> Doubles:
    """Return unit normals (K, 3), z to the viewer, rotated by an angle in degrees, each in its own direction.

    The directions are azimuths (K,) around the normals in radians. A normal that would face away is rotated
    in the opposite direction.

    >>> turned = turn(np.array([[0.0, 0.0, 1.0]]), 90.0, np.array([0.0]))
    >>> round(float(turned[0, 2]), 6)
    0.0
    """
    helper = np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    across = np.cross(normals, helper)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    along = np.cross(normals, across)
    aside = across * np.cos(azimuths)[:, None] + along * np.sin(azimuths)[:, None]
    angle = np.radians(degrees)
    turned = normals * np.cos(angle) + aside * np.sin(angle)
    other = normals * np.cos(angle) - aside * np.sin(angle)
    return np.asarray(np.where(turned[:, 2:] < np.minimum(0, other[:, 2:]), other, turned))


def _moved(point: Indices, pixels: float, inside: BoolMask, rng: np.random.Generator) -> tuple[int, int]:
    start = rng.uniform(0, 2 * np.pi)
    for azimuth in start + np.arange(_TRIES) * 2 * np.pi / _TRIES:
        row, column = np.rint(point + pixels * np.array([np.sin(azimuth), np.cos(azimuth)])).astype(int)
        if 0 <= row < inside.shape[0] and 0 <= column < inside.shape[1] and inside[row, column]:
            return int(row), int(column)
    return int(point[0]), int(point[1])
