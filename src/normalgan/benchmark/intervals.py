"""Confidence intervals over test meshes (by bootstrap) and over seeds."""

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from normalgan.arrays import Doubles, Indices
from normalgan.benchmark.training import Result

_DRAWS = 10_000
LEVEL = 0.95


class Interval(NamedTuple):
    """A figure and its confidence interval."""

    value: float
    low: float
    high: float


def mesh_interval(runs: Sequence[Result], given: str, name: str) -> Interval | None:
    """Return a method's figure with its interval over meshes; None if there are fewer than two meshes.

    The figure is pooled over the pixels of each run, as in the tables, and averaged over the runs. Meshes are
    resampled with replacement, with all their views; seeds are fixed.

    Args:
        runs: runs of one method, one per seed.
        given: hints that the method was given, such as ``15`` or ``own``.
        name: name of the figure, such as ``angular_mean``; it must be a mean over pixels.
    """
    table = _table(runs, given, name)
    if table is None:
        return None
    return _interval(len(table[0]), lambda draws: pooled(*table[1:], draws))


def difference_interval(
    runs: Sequence[Result], reference: Sequence[Result], given: str, name: str
) -> Interval | None:
    """Return the difference between a method's figure and the reference's, with its interval over meshes.

    The samples are paired: both use the same resampled meshes, so that a mesh that is hard for both cancels
    out. Seeds are fixed, so the interval applies to these trained networks, not to the methods; see
    `total_interval`. None if the meshes differ or there are fewer than two.
    """
    one, other = _table(runs, given, name), _table(reference, given, name)
    if one is None or other is None or one[0] != other[0]:
        return None
    return _interval(len(one[0]), lambda draws: pooled(*one[1:], draws) - pooled(*other[1:], draws))


def total_interval(
    runs: Sequence[Result], reference: Sequence[Result], given: str, name: str, beside: str | None = None
) -> Interval | None:
    """Return the same difference with an interval over meshes and seeds.

    The samples are paired by mesh and by common seed. The variances of the means over meshes and over seeds
    are added, which counts their interaction twice and makes the interval too wide rather than too narrow.
    The interval is Student's with Satterthwaite's degrees of freedom. None if there are fewer than two meshes
    or two common seeds. ``beside`` names the reference's hints if they differ from ``given``.

    References:
        Satterthwaite 1946, "An Approximate Distribution of Estimates of Variance Components".
    """
    both = {run.get("seed") for run in runs} & {run.get("seed") for run in reference} - {None}
    ours, theirs = (
        sorted((run for run in of if run.get("seed") in both), key=lambda run: int(run["seed"]))
        for of in (runs, reference)
    )
    one, other = _table(ours, given, name), _table(theirs, beside or given, name)
    if len(both) < 2 or one is None or other is None or one[0] != other[0]:
        return None
    by_seed, of_mesh = (a - b for a, b in zip(_parts(*one[1:]), _parts(*other[1:]), strict=True))
    meshes, seeds = len(one[0]), len(both)
    variances = np.array([meshes / (meshes - 1) * (of_mesh.mean(1) ** 2).sum(), by_seed.var(ddof=1) / seeds])
    value, total = float(by_seed.mean()), variances.sum()
    if not total:
        return Interval(value, value, value)
    freedom = total**2 / (variances**2 / [meshes - 1, seeds - 1]).sum()
    reach = float(stdtrit(freedom, (1 + LEVEL) / 2) * np.sqrt(total))
    return Interval(value, value - reach, value + reach)


def draws_of(count: int) -> Indices:
    """Return the indices of the meshes of each bootstrap draw, (draws, count), with replacement.

    These are all possible draws if there are at most `_DRAWS`, otherwise `_DRAWS` random draws.

    >>> draws_of(2).tolist()
    [[0, 0], [0, 1], [1, 0], [1, 1]]
    >>> draws_of(20).shape
    (10000, 20)
    """
    if count**count <= _DRAWS:
        return np.array(list(product(range(count), repeat=count)))
    return np.random.default_rng(0).integers(0, count, (_DRAWS, count))


def pooled(values: Doubles, pixels: Doubles, draws: Indices) -> Doubles:
    """Return the mean (draws,) over the pixels of the drawn meshes, averaged over the runs.

    Args:
        values: (meshes, runs), mean over each mesh's pixels.
        pixels: (meshes, runs), number of these pixels.
        draws: (draws, meshes), indices of the drawn meshes.
    """
    sums, counts = (values * pixels)[draws].sum(1), pixels[draws].sum(1)
    return np.asarray((sums / counts).mean(-1))


def _interval(meshes: int, figure: Callable[[Indices], Doubles]) -> Interval:
    """Return a figure of all meshes with its interval over bootstrap draws."""
    low, high = np.quantile(figure(draws_of(meshes)), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Interval(float(figure(np.arange(meshes)[None])[0]), float(low), float(high))


def _parts(values: Doubles, pixels: Doubles) -> tuple[Doubles, Doubles]:
    """Return the figure of each run, (runs,), and the contribution of each mesh to it, (meshes, runs)."""
    weights = pixels / pixels.sum(0)
    figures = (weights * values).sum(0)
    return figures, weights * (values - figures)


def _table(runs: Sequence[Result], given: str, name: str) -> tuple[list[str], Doubles, Doubles] | None:
    """Return the names of the meshes, and the values and pixels for `pooled`; None if they are missing."""
    found: list[Mapping[str, Mapping[str, float | None]]] = [
        run.get("meshes", {}).get(given, {}) for run in runs
    ]
    meshes = sorted(found[0]) if found else []
    if len(meshes) < 2 or any(sorted(one) != meshes for one in found):
        return None
    values = np.array([[one[mesh][name] for one in found] for mesh in meshes], float)
    pixels = np.array([[one[mesh]["pixels"] for one in found] for mesh in meshes], float)
    return (meshes, values, pixels) if np.isfinite(values).all() else None
