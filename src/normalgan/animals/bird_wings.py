"""Wings, folded and open, and the tail: feathers are flat sweeps, laid over one another like slates."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from normalgan.animals.frames import Floats, Frame, about, pitch, roll, yaw
from normalgan.animals.parts import Part, fuse, pair, tube
from normalgan.animals.plan import Between, Rng
from normalgan.animals.shapes import Sweep
from normalgan.animals.stations import Profile

__all__ = ["Tail", "Wing", "folded", "opened", "tail_fan"]

_STEP = 0.010  # height by which a feather lies over its neighbour
_THIN = 0.012


@dataclass(frozen=True)
class Wing:
    """A pair of wings, in units of the length of the body.

    Args:
        span: length of one open wing.
        chord: length of the inner flight feathers.
        primaries: number of feathers on the hand.
        width: half the width of a feather, in its distance from the next; small ones spread like fingers.
        pointed: from 0, a wing broad at its end, to 1, a pointed one.
        folded: how far the folded wing's tip reaches behind the rump.
        depth: half the height of the folded wing.
        high: where it lies on the side, from -1 at the belly to 1 at the back.
    """

    span: float
    chord: float
    primaries: Annotated[int, Between(2, 30)] = 9
    width: float = 0.85
    pointed: float = 0.4
    folded: float = 0.3
    depth: float = 0.17
    high: float = 0.15


@dataclass(frozen=True)
class Tail:
    """A fan of feathers, in units of the length of the body.

    Args:
        length: of the feathers.
        feathers: how many there are; 2 or more.
        half_width: of one.
        closed: degrees of the closed fan.
        raised: degrees it is raised.
    """

    length: float
    feathers: Annotated[int, Between(2, 30)]
    half_width: float
    closed: float
    raised: float


def folded(wing: Wing, body: Profile, factor: float, young: bool) -> list[Part]:
    """Return the wings laid to the sides, in the body's frame: flight feathers, then two rows of coverts.

    Args:
        wing: the wings.
        body: what they lie on.
        factor: on their length.
        young: stubs without flight feathers.
    """
    tip = -wing.folded * factor
    layers = [
        (0.80, 0.30, 0.75, 0.030) if young else (0.74, tip, 0.78, 0.022),
        (0.84, 0.14 + 0.35 * tip, 1.0, 0.034),
        (0.88, 0.36, 0.86, 0.048),
    ]
    parts = []
    for number, (first, last, deep, thick) in enumerate(layers[:1] if young else layers):
        x = np.linspace(first, last, 6)
        at = wing.high + (0.32 - wing.high) * np.clip((0.3 - x) / 0.6, 0, 1)  # tips meet over the rump
        points = np.column_stack([x, *_on_body(body, np.maximum(x, 0.04), at)])
        behind = np.clip(0.1 - x, 0, None)
        points[:, 2] = np.maximum(points[:, 2] - 0.55 * behind, 0.035) + 0.006 * number
        points[:, 1] += 0.10 * behind
        outline = np.array([0.42, 0.86, 1.0, 0.92, 0.62, 0.16]) * wing.depth * deep
        parts.append(pair(tube(points, list(outline), thick, (0.0, -0.12, 1.0)), blend=0.012))
    return parts


def _on_body(body: Profile, x: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Return y and z of points on the right side of the body, ``high`` from -1, its belly, to 1."""
    top, bottom, wide = (np.interp(x, body.x, column) for column in (body.top, body.bottom, body.half_width))
    y = (top + bottom) / 2 + high * (top - bottom) / 2
    return y, wide * np.sqrt(1 - high**2)


def opened(wing: Wing, body: Profile, factor: float, pose: str, tilt: float, rng: Rng) -> list[Part]:
    """Return the spread wings, in the body's frame.

    Args:
        wing: the wings.
        body: the bird's.
        factor: on their length.
        pose: soar, spread or land.
        tilt: degrees by which the body is raised, which the wings follow in part.
        rng: draws how far they are raised and swept.
    """
    span = wing.span * factor
    y, z = _on_body(body, np.array([0.74]), np.array([0.45]))
    shoulder = np.array([0.74, y[0], 0.7 * z[0]])
    raised = {"soar": (-4.0, 20.0), "spread": (8.0, 38.0), "land": (28.0, 55.0)}[pose]
    lift, sweep = rng.uniform(*raised), rng.uniform(-6, 12)
    flap = rng.uniform(0.0, 16.0)
    feathers = _feathers(wing, span)
    # The hand is turned up against the arm a little more.
    hand = about((0.0, 0.0, 0.5 * span), roll(flap))
    whole = about(shoulder, pitch(-0.55 * tilt if pose != "soar" else 0.0) @ roll(lift) @ yaw(-sweep))
    outer = [feather.placed(hand) for feather in feathers[: wing.primaries]]

    def placed(shapes: Sequence[Sweep], blend: float) -> Part:
        return pair(*(each.placed(Frame(shoulder, np.eye(3))).placed(whole) for each in shapes), blend=blend)

    return [placed([*outer, *feathers[wing.primaries :]], 0.0), placed(_arm(wing, span), 0.02)]


def _bones(span: float) -> Floats:
    """Return shoulder, elbow, wrist and the end of the hand, (4, 3), the wing spread to the right."""
    return span * np.array([[0, 0, 0], [-0.05, 0.012, 0.26], [0.075, 0.018, 0.50], [0.045, 0.01, 0.66]])


def _arm(wing: Wing, span: float) -> list[Sweep]:
    """Return the arm with the short feathers that cover it, thick before and thin behind."""
    bones = _bones(span)
    back = np.array([[-0.42], [-0.34], [-0.26], [-0.12]]) * wing.chord * [1.0, 0.0, 0.0]
    wide = np.array([0.50, 0.42, 0.34, 0.16]) * wing.chord
    cover = tube(bones + back * 0.8, list(wide), [0.050, 0.036, 0.028, 0.018], (0.0, 1.0, 0.0))
    bone = tube(bones, [0.075, 0.055, 0.045, 0.02], [0.06, 0.045, 0.035, 0.02], (0.0, 1.0, 0.0))
    return [cover, bone]


def _feathers(wing: Wing, span: float) -> list[Sweep]:
    """Return the flight feathers of the right wing, those of the hand first, from the tip inwards."""
    bones, feathers = _bones(span), []
    for i in range(wing.primaries):
        t = i / (wing.primaries - 1)
        base = bones[3] + t * (bones[2] - bones[3])
        angle = np.deg2rad(8 + 66 * t**0.9)
        longest = 0.36 * span + 0.15 * wing.chord
        # The outermost is the longest of a pointed wing; of a broad one, the third or fourth.
        dip = (1 - wing.pointed) * 0.22 * max(0.0, 1 - 4 * t)
        reach = (longest + (wing.chord * 1.02 - longest) * t**0.8) * (1 - dip)
        feathers.append(_feather(base, np.array([-np.sin(angle), 0, np.cos(angle)]), reach, wing, span, i))
    inner = max(6, wing.primaries - 2)
    for i in range(inner):
        t = (i + 0.7) / inner
        base = bones[2] + (bones[1] - bones[2]) * min(2 * t, 1) + (bones[0] - bones[1]) * max(2 * t - 1, 0)
        angle = np.deg2rad(78 + 14 * t)
        reach = wing.chord * (1.0 - 0.12 * t)
        feathers.append(_feather(base, np.array([-np.sin(angle), 0, np.cos(angle)]), reach, wing, span, i))
    return feathers


def _feather(base: Floats, way: Floats, length: float, wing: Wing, span: float, number: int) -> Sweep:
    half = wing.width * 0.075 * span
    over = np.array([0.0, _STEP * (number % 2), 0.0])
    return tube([base + over, base + way * (length - half) + over], [half * 0.9, half], _THIN, (0, 1, 0))


def tail_fan(tail: Tail, factor: float, spread: float, aside: float) -> list[Part]:
    """Return the tail, in the body's frame.

    Args:
        tail: its feathers.
        factor: on its length.
        spread: degrees between the outermost feathers.
        aside: degrees to the left.
    """
    count, half, raised = tail.feathers, tail.half_width, tail.raised
    feathers = []
    for i in range(count):
        t = 2 * i / (count - 1) - 1
        turn = pitch(-raised) @ yaw(aside + t * spread / 2)
        way = turn @ np.array([-1.0, 0.0, 0.0])
        start = np.array([0.16, 0.03, 0.0])
        over = turn @ np.array([0.0, _STEP * (1 - abs(t)) * 2.0 + _STEP * (i % 2), 0.0])
        end = start + way * (tail.length * factor + 0.16 - half) * (1 - 0.08 * t * t) + over
        upward = turn @ np.array([0.0, 1.0, 0.0])
        feathers.append(tube([start + over, end], [0.7 * half, half], _THIN, upward))
    rear = pitch(-raised) @ np.array([-0.12, 0.0, 0.0]) + [0.05, 0.03, 0.0]
    rump = tube([np.array([0.22, 0.03, 0.0]), rear], [0.10, 0.04], [0.11, 0.05])
    return [fuse(*feathers, blend=0.01), fuse(rump, blend=0.08)]
