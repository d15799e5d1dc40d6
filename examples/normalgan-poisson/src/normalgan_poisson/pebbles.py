"""Pebbles, a source of training pairs: drawings and normal maps of heaps of round stones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from normalgan.data.sources import Pair, PairSource, SplitSettings
from normalgan.errors import InputError
from normalgan_poisson.darts import throw_darts

__all__ = ["Heap", "Pebbles"]


@dataclass(frozen=True)
class Heap:
    """Stones with centres thrown as darts, so that they overlap but never hide one another.

    Args:
        name: the name of the pair.
        seed: seed of the places of the stones.
        size: side of the picture in pixels.
        distance: minimum distance between the centres of two stones in pixels.
    """

    name: str
    seed: int
    size: int
    distance: float

    def fingerprint(self) -> str:
        """Return everything that the pair depends on: all settings, and a version of this code."""
        return f"heap 1 {self.seed} {self.size} {self.distance}"

    def load(self) -> Pair:
        """Return the outlines of the stones as a sketch, and the normals of their upper halves."""
        radius = 0.7 * self.distance
        y, x = np.mgrid[: self.size, : self.size] + 0.5
        middle = self.size / 2
        room = np.hypot(x - middle, y - middle) < middle - radius - 2
        priority = np.random.default_rng(self.seed).random((self.size, self.size))
        landed = throw_darts(torch.from_numpy(room)[None], torch.from_numpy(priority)[None], self.distance)
        rows, columns = np.nonzero(landed[0].numpy())
        # (stones, H, W): the offset from each stone's centre, and the height of the stone there.
        right, up = x - columns[:, None, None] - 0.5, rows[:, None, None] + 0.5 - y
        height = np.sqrt(np.clip(radius**2 - right**2 - up**2, 0, None))
        top = height.argmax(0)[None]
        seen = [np.take_along_axis(each, top, 0)[0] for each in (right, up, height)]
        mask = seen[2] > 0
        normal = np.stack(seen, axis=-1) / radius * mask[..., None]
        stone = np.where(mask, top[0], -1)
        beside = np.pad(stone, 1, mode="edge")
        outline = np.any([beside[1:-1, 2:] != stone, beside[2:, 1:-1] != stone], axis=0)
        return Pair(1.0 - outline, normal, mask=mask)


@dataclass(frozen=True)
class Pebbles(PairSource):
    """Heaps of round stones, all different.

    Args:
        count: number of heaps.
        size: side of a picture in pixels.
        distance: minimum distance between the centres of two stones in pixels.

    Raises:
        InputError: if a setting is out of range.
    """

    count: int = 50
    size: int = 128
    distance: float = 24.0

    def __post_init__(self) -> None:
        if self.count < 1:
            raise InputError(f"Pebbles was given count={self.count}; use 1 heap or more.")
        if not 4 <= self.distance <= self.size / 4:
            raise InputError(
                f"Pebbles was given distance={self.distance}; use 4 pixels to a quarter of size={self.size}."
            )

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Heap]]:
        """Return the heaps of each split."""
        first = settings.data_seed * 1_000_000
        heaps = {f"heap{i}": Heap(f"heap{i}", first + i, self.size, self.distance) for i in range(self.count)}
        names = settings.deal(list(heaps), "heap")
        return {split: [heaps[name] for name in part] for split, part in names.items()}
