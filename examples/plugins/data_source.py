"""A data source, which returns the items of each split; each item loads one pair."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from normalgan.data.sources import DATA_SOURCES, Pair, PairSource, SplitSettings
from normalgan.testing import check


@dataclass(frozen=True)
class Disc:
    """A disc with a bulge."""

    name: str
    bulge: float

    def fingerprint(self) -> str:
        """Return everything that the picture depends on: all settings, and a version of this code."""
        return f"disc 1 {self.bulge}"

    def load(self) -> Pair:
        """Return the sketch and the normal map, of any size."""
        x, y = np.meshgrid(np.linspace(-1.2, 1.2, 64), np.linspace(1.2, -1.2, 64))
        radius = np.hypot(x, y)
        up = np.sqrt(np.clip(1 - radius**2, 0, 1)) + 1e-3
        normal = np.stack([x, y, up / self.bulge], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        paper = 1.0 - (np.abs(radius - 0.97) < 0.04)
        return Pair(paper, normal, mask=radius < 1)


@DATA_SOURCES.register
@dataclass(frozen=True)
class Discs(PairSource):
    """Discs, each with a larger bulge than the previous one.

    Args:
        count: number of discs.
    """

    count: int = 10

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Disc]]:
        """Return the discs of each split."""
        discs = {f"disc{i}": Disc(f"disc{i}", 1 + i / 10) for i in range(self.count)}
        return {part: [discs[name] for name in names] for part, names in settings.deal(list(discs)).items()}


if __name__ == "__main__":
    assert len(Discs(10).split(SplitSettings())["test"]) == 2
    check(Discs(10))
