"""Spines: a straight body and what grows on it, bent sideways: fish, lizards, snakes, tails."""

import numpy as np

from normalgan.animals.chain import Frame, yaw
from normalgan.animals.sweep import Floats, Sweep


class Spine:
    """A body bent sideways: carries points and frames of the straight one along.

    Args:
        xs: (n,) positions along the straight body.
        turns: (n,) degrees by which it is turned to its left at each.
    """

    def __init__(self, xs: Floats, turns: Floats) -> None:
        self.xs, self.turns = xs, np.deg2rad(turns)
        steps = np.diff(xs)
        middle = (self.turns[1:] + self.turns[:-1]) / 2
        self.along = np.concatenate([[0.0], np.cumsum(steps * np.cos(middle))])
        self.aside = np.concatenate([[0.0], np.cumsum(-steps * np.sin(middle))])

    def frame(self, x: float) -> Frame:
        """Return the frame at position ``x``; the ends go on straight."""
        at = float(np.clip(x, self.xs[0], self.xs[-1]))
        angle = float(np.interp(at, self.xs, self.turns))
        over = x - at
        origin = np.array([
            float(np.interp(at, self.xs, self.along)) + over * np.cos(angle), 0.0,
            float(np.interp(at, self.xs, self.aside)) - over * np.sin(angle),
        ])  # fmt: skip
        return Frame(origin, yaw(float(np.rad2deg(angle))))

    def place(self, points: Floats) -> Floats:
        """Return (n, 3) points of the straight body where the bent one has them."""
        moved = []
        for x, y, z in points:
            moved.append(self.frame(float(x)).place(np.array([[0.0, y, z]]))[0])
        return np.array(moved)

    def trunk(self, rows: Floats) -> Sweep:
        """Return the sweep of stations (x, top, bottom, half width), bent with the spine."""
        middles = np.column_stack([rows[:, 0], (rows[:, 1] + rows[:, 2]) / 2, np.zeros(len(rows))])
        sides = np.array([self.frame(float(x)).rotation[:, 2] for x in rows[:, 0]])
        return Sweep(self.place(middles), (rows[:, 1] - rows[:, 2]) / 2, rows[:, 3].copy(), sides)
