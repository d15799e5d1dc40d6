"""Placements: ways of placing hints, to compare positions at equal counts."""

from collections.abc import Callable, Sequence

from normalgan.hints import (
    CurvatureHints,
    FarthestPointHints,
    HintSampler,
    UniformHints,
    WorstErrorHints,
)

__all__ = ["placements"]

_SAMPLERS: dict[str, Callable[[int], HintSampler]] = {
    "uniform": lambda count: UniformHints(count, count),
    "curvature": lambda count: CurvatureHints(count=count),
    "farthest": FarthestPointHints,
    "worst": WorstErrorHints,
}
"""By name: anywhere on the object; where the paper's sampler looks; far from one another; where a method is
most wrong without hints, which only an oracle knows."""


def placements(names: Sequence[str], counts: Sequence[int]) -> dict[str, HintSampler]:
    """Return a sampler for each name and count, by what its figures are called.

    Args:
        names: of `PLACEMENTS`.
        counts: hints of each sample.

    >>> list(placements(["uniform", "worst"], [3, 10]))
    ['uniform-3', 'uniform-10', 'worst-3', 'worst-10']
    """
    return {f"{name}-{count}": _SAMPLERS[name](count) for name in names for count in counts}
