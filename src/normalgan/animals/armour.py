"""Armour of quadrupeds: plates and spikes along the line of the back, a frill behind the head."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.animals.frames import Floats, Frame, spanned, way_along
from normalgan.animals.parts import Part, fuse, tube
from normalgan.animals.plan import Between, Rng
from normalgan.animals.shapes import Plate, Sweep, rounded

__all__ = ["Armour"]

_LEAF = ((-0.42, -0.15), (-0.50, 0.30), (-0.26, 0.72), (0.02, 1.0), (0.26, 0.70), (0.50, 0.28), (0.40, -0.15))


@dataclass(frozen=True)
class Armour:
    """What grows along the line of the back of some dinosaurs.

    Args:
        plates: how many there are, in two rows.
        height: of the largest plate, in units of the height at the withers.
        spikes: pairs of spikes near the tip of the tail.
        frill: reach of a shield behind the head in units of the length of the head; 0 for none.
    """

    plates: Annotated[int, Between(0, 100)] = 0
    height: float = 0.0
    spikes: Annotated[int, Between(0, 8)] = 0
    frill: float = 0.0

    def grow(self, neck: Sweep, skull: Sweep, torso: Sweep, tail: Sweep, rng: Rng) -> list[Part]:
        """Return the parts of it, on one individual's body."""
        parts = []
        size = self.height * rng.uniform(0.85, 1.2)
        if self.plates:
            parts += _rows(_back(neck, torso, tail), self.plates, size)
        if self.spikes:
            parts.append(fuse(*_spikes(tail, self.spikes, size), blend=0.03))
        if self.frill:
            parts.append(fuse(_frill(skull, self.frill * rng.uniform(0.85, 1.15)), blend=0.06))
        return parts


def _back(neck: Sweep, torso: Sweep, tail: Sweep) -> Floats:
    """Return the line of the back from behind the head to the tip of the tail, (n, 3)."""
    fine = [each.smoothed(8) for each in (neck, torso, tail)]
    tops = [each.points + np.outer(each.radii, [0.0, 1.0, 0.0]) for each in fine]
    ahead = tops[0][tops[0][:, 0] > tops[1][-1, 0]][::-1]
    behind = tops[2][tops[2][:, 0] < tops[1][0, 0]]
    line: Floats = np.vstack([ahead, tops[1][::-1], behind])
    return line


def _rows(line: Floats, count: int, size: float) -> list[Part]:
    plates = []
    for i in range(count):
        t = (i + 0.6) / count
        tall = size * (0.30 + 0.70 * np.sin(np.pi * (0.06 + 0.88 * t)) ** 1.1)
        plates.append(_plate(line, 0.02 + 0.78 * t, tall, 1.0 if i % 2 else -1.0))
    # Each row is a part of its own, or neighbours would melt into one another.
    return [fuse(*plates[0::2], blend=0.03), fuse(*plates[1::2], blend=0.03)]


def _plate(line: Floats, share: float, tall: float, side: float) -> Plate:
    steps = way_along(line)
    before, at, after = (
        np.array([np.interp(share * steps[-1] + far, steps, column) for column in line.T])
        for far in (-0.12, 0.0, 0.12)
    )
    ahead = (before - after) / np.linalg.norm(before - after)
    frame = spanned(at + np.array([0.0, 0.0, 0.035 * side]), ahead, np.array([0.0, 1.0, 0.30 * side]))
    return Plate(frame, rounded(_LEAF, 1) * tall * [0.92, 1.0], 0.012, 0.12, 0.035)


def _spikes(tail: Sweep, pairs: int, size: float) -> list[Sweep]:
    fine = tail.smoothed(8)
    spikes: list[Sweep] = []
    for i in range(pairs):
        at = len(fine.points) - 3 - 4 * i
        root = fine.points[at]
        for sign in (1.0, -1.0):
            tip = root + size * 0.75 * np.array([-0.45, 0.55, 0.75 * sign])
            spikes.append(tube([root, (root + tip) / 2, tip], [0.032, 0.026, 0.010]))
    return spikes


def _frill(skull: Sweep, reach: float) -> Plate:
    """Return the shield behind the head, scalloped, hollow towards the front."""
    nose = skull.points[-1] - skull.points[0]
    length = float(np.linalg.norm(nose))
    ahead, right = nose / length, skull.sides[0]
    up = np.cross(right, ahead)
    tall = -0.62 * ahead + 0.78 * up
    across = np.cross(tall, right)
    rim = []
    for i, angle in enumerate(np.deg2rad(np.linspace(-28, 208, 27))):
        far = reach * length * (1.0 if i % 2 else 0.93)
        rim.append((0.86 * far * float(np.cos(angle)), far * (0.20 + 0.80 * float(np.sin(angle)))))
    origin = skull.points[0] + length * (0.12 * ahead + 0.06 * up)
    frame = Frame(origin, np.column_stack([right, tall, across]))
    return Plate(frame, rounded(rim, 1), 0.03, 0.10, 0.05, bow=(0.5 / length, 0.0))
