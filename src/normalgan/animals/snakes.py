"""Snakes: a long tube that tapers, coiled, winding or raised, a hood for cobras."""

import numpy as np

from normalgan.animals.chain import Frame, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, carried, fuse, tube
from normalgan.animals.plan import Form, Rng
from normalgan.animals.shapes import trunk
from normalgan.animals.sweep import Floats, Sweep

HEAD = (
    (-0.55, 0.26, -0.26, 0.30), (-0.25, 0.34, -0.30, 0.50), (0.10, 0.34, -0.30, 0.52),
        (0.45, 0.24, -0.26, 0.40),
    (0.75, 0.10, -0.22, 0.28), (0.88, 0.02, -0.16, 0.20),
)  # fmt: skip


def snake(hooded: bool) -> Form:
    """Return the body plan of a snake, or of a cobra if ``hooded``."""
    poses = ("rear", "rear", "coil") if hooded else ("coil", "coil", "wind", "wind", "rear")
    return Form(poses, lambda pose, rng: assemble(hooded, pose, rng))


def assemble(hooded: bool, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one snake, in the order in which they blend."""
    fat = float(rng.uniform(0.060, 0.085))
    line = {"coil": _coil, "wind": _wind, "rear": _rear}[pose](fat, rng)
    steps = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    share = steps / steps[-1]  # 0 at the tip of the tail, 1 at the head
    radii = fat * np.interp(share, [0, 0.18, 0.5, 0.85, 1.0], [0.16, 0.62, 1.0, 0.92, 0.62])
    line[:, 1] += radii - fat  # every part of it lies on the ground, or on the coil below
    way = line[-1] - line[-2]
    heading = float(np.rad2deg(np.arctan2(-way[2], way[0])))
    level = float(rng.uniform(-18, 4)) - (8.0 if hooded else 0.0)
    head = Frame(line[-1], yaw(heading) @ pitch(level))
    parts = [fuse(tube(line, list(radii)))]
    if hooded and pose == "rear":
        parts.append(fuse(_hood(line, fat, yaw(heading)[:, 2], rng), blend=0.03))
    eyes = ball((0.36, 0.20, 0.37), 0.115)
    mouth = tube([(-0.05, -0.08, 0.53), (0.35, -0.10, 0.46), (0.75, -0.08, 0.30), (1.02, -0.08, 0.12)], 0.035)
    pits = tube([(0.95, 0.02, 0.14), (0.85, 0.05, 0.18)], 0.045)
    face = [
        fuse(trunk(HEAD), blend=0.4), fuse(*both(eyes)),
        fuse(*both(mouth, pits), carve=True, blend=0.02),
    ]  # fmt: skip
    return parts + carried(face, head, 1.75 * fat * float(rng.uniform(0.9, 1.2)))


def _coil(fat: float, rng: Rng) -> Floats:
    """Return a spiral from the tip of the tail outside to the head raised in the middle."""
    turns, gap = float(rng.uniform(2.2, 3.0)), 1.9 * fat
    angle = np.linspace(0, 2 * np.pi * turns, int(14 * turns))
    radius = 0.16 + gap * (angle[-1] - angle) / (2 * np.pi)
    rise = fat + 0.75 * fat * angle / (2 * np.pi)  # each turn lies half on the one outside it
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    phase = -angle[-1] - np.pi / 2
    spiral = np.column_stack([radius * np.cos(angle + phase), rise, side * radius * np.sin(angle + phase)])
    tall = float(rng.uniform(0.10, 0.30))
    end = spiral[-1]
    neck = np.array(
        [[0.12, 0.05, 0.02], [0.16, 0.45, 0.0], [0.04, 0.9, 0.0], [0.10, 1.15, 0.0], [0.26, 1.18, 0.0]]
    )
    raised = np.array([end[0], end[1], 0.6 * end[2]]) + neck * [1.0, tall + 0.08, side]
    raised[:, 2] = np.linspace(end[2], 0.0, 6)[1:]
    return np.vstack([spiral, raised])


def _wind(fat: float, rng: Rng) -> Floats:
    """Return a line that winds over the ground, to a head held a little high."""
    x = np.linspace(-1.0, 0.72, 40)
    waves, size = float(rng.uniform(1.4, 2.3)), float(rng.uniform(0.16, 0.26))
    grow = np.clip((0.80 - x) / 0.45, 0, 1)
    z = size * grow * np.sin(waves * np.pi * (x + 1.0) + float(rng.uniform(0, 2 * np.pi)))
    y = fat + float(rng.uniform(0.0, 0.14)) * np.clip((x - 0.45) / 0.27, 0, 1) ** 1.5
    return np.column_stack([x, y, z])


def _rear(fat: float, rng: Rng) -> Floats:
    """Return a coil from which the front third stands up."""
    turns = float(rng.uniform(1.3, 1.9))
    angle = np.linspace(0, 2 * np.pi * turns, int(14 * turns))
    radius = 0.20 + 1.9 * fat * (angle[-1] - angle) / (2 * np.pi)
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    phase = -angle[-1] - 0.75 * np.pi
    rise = fat + 0.5 * fat * angle / (2 * np.pi)
    spiral = np.column_stack([radius * np.cos(angle + phase), rise, side * radius * np.sin(angle + phase)])
    end, tall = spiral[-1], float(rng.uniform(0.55, 0.85))
    up = np.array([[0.15, 0.06], [0.20, 0.26], [0.14, 0.52], [0.10, 0.78], [0.13, 0.94], [0.24, 1.0]])
    stand = np.column_stack([end[0] + up[:, 0], end[1] + tall * up[:, 1], np.linspace(end[2], 0, 7)[1:]])
    return np.vstack([spiral, stand])


def _hood(line: Floats, fat: float, side: Floats, rng: Rng) -> Sweep:
    """Return the spread neck of a cobra."""
    upper = line[-5:]
    wide = fat * float(rng.uniform(2.2, 2.9)) * np.array([0.35, 0.72, 1.0, 0.80, 0.35])
    return tube(upper, [0.8 * fat, 0.62 * fat, 0.5 * fat, 0.5 * fat, 0.5 * fat], list(wide), side)
