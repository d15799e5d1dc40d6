"""Heads of bipeds, in head heights, with the base of the skull at the origin and the face towards +x."""

from collections.abc import Callable, Mapping

import numpy as np

from normalgan.animals.frames import pitch, roll, yaw
from normalgan.animals.parts import Part, Ripple, ball, block, fuse, pair, tube
from normalgan.animals.plan import Rng


def _eyes(x: float, y: float, z: float, radius: float, socket: float = 1.5) -> list[Part]:
    dug = ball([x + 0.6 * radius, y, z], [socket * radius, 0.9 * socket * radius, socket * radius])
    return [pair(dug, blend=0.06, carve=True), pair(ball([x - 0.3 * radius, y, z], radius))]


def _mouth(x: float, y: float, wide: float, curve: float = 0.03) -> Part:
    t = np.linspace(-1, 1, 7)
    rows = np.column_stack([x - 0.28 * wide * t**2, y + curve * t**2, wide * t])
    return fuse(tube(rows, 0.018), blend=0.012, carve=True)


def _human(rng: Rng) -> list[Part]:
    """A person's head: skull, jaw, nose, ears, and hair or a hat."""
    wide = rng.uniform(0.93, 1.08)
    jaw = rng.uniform(0.9, 1.1)
    parts = [
        fuse(ball((0.03, 0.60), [0.45, 0.41, 0.36 * wide])),
        fuse(ball((0.15, 0.24), [0.25 * jaw, 0.28, 0.26 * wide * jaw]), blend=0.3),
        fuse(ball((0.28, 0.02 + 0.06), [0.12, 0.10, 0.13]), blend=0.12),
        *_eyes(0.40, 0.46, 0.155 * wide, 0.055, 1.2),
        _mouth(0.405, 0.17, 0.12),
    ]
    nose = rng.uniform(0.8, 1.35)
    bridge = [(0.40, 0.50), (0.43 + 0.05 * nose, 0.36), (0.40 + 0.10 * nose, 0.29)]
    parts.append(fuse(tube(bridge, [0.035, 0.05, 0.062]), blend=0.05))
    ear = ball([0.0, 0.42, 0.355 * wide], [0.085, 0.13, 0.05], yaw(25) @ roll(-8))
    parts.append(pair(ear, blend=0.02))
    return parts + _hair(str(rng.choice(_HAIR)), wide, rng)


_HAIR = ("cap", "cap", "bun", "tail", "long", "curly", "bald", "hat", "brim")


def _hair(kind: str, wide: float, rng: Rng) -> list[Part]:
    if kind == "bald":
        return []
    if kind in {"hat", "brim"}:
        tilt = pitch(rng.uniform(-4, 10))
        crown = ball((0.01, 0.72), [0.49, 0.36, 0.42 * wide], tilt)
        if kind == "brim":
            disc = ball((0.0, 0.72), [0.85, 0.05, 0.72], tilt)
            return [fuse(crown), fuse(disc, blend=0.06)]
        return [fuse(crown), fuse(ball((0.42, 0.70), [0.30, 0.04, 0.28], tilt), blend=0.03)]
    fringe = rng.uniform(-0.10, -0.04)
    cap = ball((fringe, 0.68), [0.50, 0.43, 0.44 * wide])
    nape = ball((-0.20, 0.40), [0.29, 0.34, 0.37 * wide])
    parts = [fuse(cap, blend=0.015), fuse(nape, blend=0.08)]
    if kind == "bun":
        parts.append(fuse(ball((-0.32, 1.0), rng.uniform(0.17, 0.24)), blend=0.04))
    elif kind == "tail":
        rows = [[-0.40, 0.78, 0], [-0.66, 0.76, 0], [-0.74, 0.42, 0], [-0.70, 0.0, 0]]
        parts.append(fuse(tube(rows, [0.10, 0.14, 0.15, 0.06]), blend=0.03))
    elif kind == "long":
        end = rng.uniform(-0.55, 0.0)
        rows = [[-0.12, 0.62, 0.0], [-0.24, 0.25, 0.0], [-0.24, end, 0.0]]
        parts.append(fuse(tube(rows, [0.30, 0.23, 0.14], [0.40, 0.42, 0.36]), blend=0.06))
    elif kind == "curly":
        puff = ball((fringe - 0.06, 0.68), [0.54, 0.47, 0.52 * wide])
        parts = [fuse(puff, ripple=Ripple(0.035, 0.22), blend=0.02), parts[1]]
    return parts


def _toon(rng: Rng) -> list[Part]:
    """A cartoon's head: a large ball with large eyes."""
    wide = rng.uniform(0.95, 1.12)
    parts = [
        fuse(ball((0.0, 0.52), [0.46, 0.47, 0.48 * wide])),
        pair(ball([0.20, 0.32, 0.2], [0.22, 0.2, 0.22]), blend=0.12),
        pair(ball([0.37, 0.52, 0.155], [0.10, 0.15, 0.105]), blend=0.01),
        fuse(ball((0.48, 0.37), rng.uniform(0.06, 0.13)), blend=0.02),
        _mouth(0.43, 0.19, 0.16, 0.07),
        pair(ball([-0.02, 0.42, 0.48 * wide], [0.10, 0.12, 0.06], yaw(20)), blend=0.02),
    ]
    kind = str(rng.choice(("tuft", "cap", "spikes", "pigtails", "hat")))
    if kind == "tuft":
        curl = [(0.0, 0.95), (-0.02, 1.15), (0.10, 1.24), (0.2, 1.16)]
        parts.append(fuse(tube(curl, [0.07, 0.06, 0.05, 0.03]), blend=0.05))
    elif kind == "spikes":
        lean = np.linspace(-70, 70, 6)
        for i, angle in enumerate(lean):
            turn = roll(float(angle)) @ pitch(-20.0 + 12 * (i % 2))
            rows = np.array([[-0.06, 0.36, 0], [-0.08, 0.58, 0], [-0.12, 0.76, 0]]) @ turn.T + [0, 0.5, 0]
            parts.append(fuse(tube(rows, [0.16, 0.10, 0.02]), blend=0.03))
    elif kind == "hat":
        parts.append(fuse(tube([(0, 0.9), (-0.1, 1.2), (-0.28, 1.45)], [0.33, 0.18, 0.05]), blend=0.02))
        parts.append(fuse(ball((-0.30, 1.48), 0.1), blend=0.02))
    else:
        parts.append(fuse(ball((-0.09, 0.62), [0.47, 0.46, 0.52 * wide]), blend=0.01))
        if kind == "pigtails":
            tails = tube([[-0.1, 0.72, 0.46], [-0.1, 0.74, 0.74], [-0.12, 0.42, 0.86]], [0.07, 0.15, 0.05])
            parts.append(pair(tails, blend=0.02))
    return parts


def _monkey(rng: Rng) -> list[Part]:
    """A monkey's head: round skull, heart-shaped face, muzzle, big ears."""
    ears = rng.uniform(0.85, 1.25)
    return [
        fuse(ball((0.0, 0.60), [0.42, 0.42, 0.40])),
        fuse(ball((0.30, 0.30), [0.26, 0.24, 0.29]), blend=0.12),
        pair(ball([0.30, 0.62, 0.13], [0.15, 0.16, 0.16]), blend=0.04),
        *_eyes(0.415, 0.58, 0.13, 0.052),
        fuse(tube([(0.42, 0.50), (0.54, 0.40)], [0.035, 0.055], [0.05, 0.085]), blend=0.04),
        _mouth(0.535, 0.23, 0.19, 0.05),
        pair(ball([-0.02, 0.56, 0.47], [0.10, 0.20 * ears, 0.17 * ears], yaw(-30)), blend=0.02),
        pair(ball([0.06, 0.56, 0.50], [0.06, 0.11 * ears, 0.09 * ears], yaw(-30)), blend=0.03, carve=True),
    ]


def _gorilla(rng: Rng) -> list[Part]:
    """A gorilla's head: crest, brow, broad muzzle, small ears."""
    crest = rng.uniform(0.75, 1.1)
    return [
        fuse(ball((-0.02, 0.52), [0.42, 0.40, 0.36])),
        fuse(ball((-0.10, 0.78), [0.28, 0.30 * crest, 0.20]), blend=0.25),
        fuse(ball((0.28, 0.22), [0.27, 0.27, 0.30]), blend=0.14),
        fuse(tube([[0.30, 0.60, -0.24], [0.385, 0.63, 0], [0.30, 0.60, 0.24]], 0.075), blend=0.06),
        *_eyes(0.37, 0.50, 0.12, 0.045),
        pair(ball([0.53, 0.36, 0.055], [0.06, 0.06, 0.075]), blend=0.05),
        _mouth(0.545, 0.15, 0.20, -0.03),
        pair(ball([-0.06, 0.48, 0.37], [0.06, 0.10, 0.05]), blend=0.02),
    ]


def _bear(rng: Rng) -> list[Part]:
    """A bear's head: broad skull, long muzzle, round ears on top."""
    long = rng.uniform(0.9, 1.15)
    tip = 0.24 + 0.46 * long
    return [
        fuse(ball((0.05, 0.48), [0.44, 0.40, 0.43])),
        fuse(tube([(0.20, 0.36), (tip - 0.10, 0.31)], [0.27, 0.19], [0.28, 0.20]), blend=0.12),
        fuse(ball((tip + 0.07, 0.40), [0.06, 0.06, 0.09]), blend=0.02),
        *_eyes(0.415, 0.54, 0.17, 0.045),
        fuse(tube([[0.45, 0.20, 0.2], [tip, 0.20, 0.15], [tip + 0.075, 0.22, 0], [tip, 0.20, -0.15],
                   [0.45, 0.20, -0.2]], 0.02), blend=0.012, carve=True),
        pair(ball([-0.04, 0.86, 0.33], [0.085, 0.20, 0.19], yaw(-15)), blend=0.03),
        pair(ball([0.05, 0.88, 0.35], [0.06, 0.12, 0.11], yaw(-15)), blend=0.03, carve=True),
    ]  # fmt: skip


def robot(rng: Rng) -> list[Part]:
    """A robot's head: a box with lamps, a grille and antennas."""
    tall, wide = rng.uniform(0.36, 0.5), rng.uniform(0.38, 0.55)
    low = 0.5 - tall
    lamp = rng.uniform(0.07, 0.12)
    parts = [
        fuse(tube([(0, -0.3), (0, 0.2)], 0.16)),
        fuse(block((0, 0.5), [0.36, tall, wide], rng.uniform(0.04, 0.2))),
        pair(tube([[0.25, 0.58, 0.45 * wide], [0.42, 0.58, 0.45 * wide]], lamp, flat=True)),
    ]
    for y in (0.16, 0.24, 0.32):
        groove = block((0.37, low + y), [0.05, 0.014, 0.5 * wide], 0.01)
        parts.append(fuse(groove, carve=True))
    if rng.uniform() < 0.6:
        mast = tube([(0, 0.5 + tall - 0.1), (0, 0.5 + tall + 0.25)], 0.035)
        parts += [fuse(mast), fuse(ball((0, 0.5 + tall + 0.3), 0.09))]
    else:
        plugs = tube([[0, 0.55, wide - 0.05], [0, 0.55, wide + 0.12]], 0.13, flat=True)
        parts.append(pair(plugs, ball([0, 0.55, wide + 0.15], 0.06)))
    return parts


HEADS: Mapping[str, Callable[[Rng], list[Part]]] = {
    "bear": _bear, "gorilla": _gorilla, "human": _human, "monkey": _monkey, "toon": _toon,
}  # fmt: skip
"""The heads of animals and people by name."""
