"""The birds: what a kind is, in units of the length of its body, and how its parts come together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from normalgan.animals.bird_legs import Legs
from normalgan.animals.bird_wings import Tail, Wing, folded, opened, tail_fan
from normalgan.animals.frames import Frame, bend, pitch, yaw
from normalgan.animals.parts import Part, Ripple, ball, both, carried, fuse, pair, tube
from normalgan.animals.plan import Eyeball, PosedPlan, Range, Rng, proportions
from normalgan.animals.shapes import Plate, Shape, Sweep, rounded
from normalgan.animals.stations import Profile, Stations

__all__ = ["Bird"]

_Extra = Callable[[Rng, float], list[Part]]


def _comb(rng: Rng, _: float) -> list[Part]:
    """Return a cock's comb and wattles; a hen's are smaller."""
    size = rng.uniform(0.6, 1.25)
    edge = [(-0.42, 0.28), (-0.46, 0.60), (-0.28, 0.52), (-0.20, 0.80), (-0.06, 0.56), (0.06, 0.84),
            (0.18, 0.54), (0.32, 0.68), (0.40, 0.40), (0.30, 0.20)]  # fmt: skip
    outline = rounded([(x, 0.3 + (y - 0.3) * size) for x, y in edge], 1)
    lobe = tube([(0.34, -0.22, 0.10), (0.36, -0.22 - 0.36 * size, 0.14)], [0.08, 0.13], 0.05)
    crest = Plate(Frame(np.zeros(3), np.eye(3)), outline, rim=0.055)
    return [fuse(crest, blend=0.03), pair(lobe, blend=0.03)]


def _sickles(rng: Rng, factor: float) -> list[Part]:
    """Return the drooping tail feathers of a cock; hens have none."""
    if rng.uniform() < 0.5:
        return []
    arcs: list[Shape] = []
    for i in range(4):
        z, reach = 0.02 + 0.03 * i, factor * (1.25 - 0.14 * i)
        arc = np.array([(0.1, 0.1), (-0.12, 0.42), (-0.40, 0.60), (-0.66, 0.52), (-0.80, 0.26)]) * reach
        aside = np.array([1.0, 1.0, 1.4, 1.8, 2.0]) * z
        arcs += both(tube(np.column_stack([arc, aside]), [0.05, 0.065, 0.06, 0.05, 0.02], 0.018))
    return [fuse(*arcs, blend=0.01)]


def _tufts(rng: Rng, _: float) -> list[Part]:
    """Return an owl's veil of feathers round the eyes, and the ears of some."""
    parts = [pair(tube([(0.30, 0.06, 0.17), (0.335, 0.06, 0.19)], 0.24, 0.24), blend=0.03),
             pair(tube([(0.40, 0.07, 0.19), (0.70, 0.075, 0.30)], 0.18), blend=0.05, carve=True),
             pair(tube([(0.30, 0.08, 0.18), (0.31, 0.08, 0.185)], 0.155))]  # fmt: skip
    if rng.uniform() < 0.6:
        line = [(0.16, 0.34, 0.22), (0.10, 0.52, 0.33), (0.02, 0.72, 0.42)]
        parts.append(pair(tube(line, [0.12, 0.09, 0.02], [0.07, 0.05, 0.02]), blend=0.06))
    return parts


def _plume(_: Rng, factor: float) -> list[Part]:
    """Return the plumes at the back of a heron's head."""
    plume = tube([(-0.3, 0.18), (-0.75, 0.14), (-1.25 * factor, -0.12)], [0.07, 0.06, 0.02])
    return [fuse(plume, blend=0.04)]


def _brow(_: Rng, __: float) -> list[Part]:
    """Return the ridge over an eagle's eye."""
    ridge = tube([(-0.02, 0.21, 0.34), (0.20, 0.22, 0.31), (0.36, 0.15, 0.21)], [0.05, 0.06, 0.04])
    return [pair(ridge, blend=0.06)]


_FACES: Mapping[str, _Extra] = {"brow": _brow, "comb": _comb, "plume": _plume, "tufts": _tufts}
_TRAINS: Mapping[str, _Extra] = {"sickles": _sickles}
_POSES = ("stand", "walk", "feed", "perch", "one_leg", "swim", "spread", "soar", "land")
_YOUNG_SHARE = 0.15
_RANGES: Mapping[str, Range] = {
    "girth": (0.88, 1.15), "neck": (0.9, 1.12), "head": (0.92, 1.12), "beak": (0.85, 1.18),
    "tail": (0.8, 1.2), "legs": (0.88, 1.12), "wing": (0.9, 1.12),
}  # fmt: skip
_CHICK: Mapping[str, float] = {
    "girth": 1.0, "neck": 1.05, "head": 1.3, "beak": 0.7, "tail": 0.4, "legs": 0.85, "wing": 0.6,
}  # fmt: skip


@dataclass(frozen=True)
class Bird(PosedPlan):
    """A kind of bird.

    Args:
        habits: the poses it is seen in; one named twice is drawn twice as often.
        body: from the rump, x = 0, to the breast, x = 1, lying flat.
        pitch: degrees by which the breast is raised when it stands.
        neck: from inside the breast to the head, in the upright bird, as differences from the first.
        low: the same stations when it feeds.
        skull_size: size of the head.
        skull: its sections in its own frame, in units of its size; or the name of a shared one.
        eye: in the skull's frame and unit.
        beak: the upper half, in the skull's frame and unit.
        jaw: the lower half, in the skull's frame and unit.
        wing: the wings.
        tail: the tail.
        leg: the legs.
        face: crest, comb or tufts, or None.
        train: sickle feathers, or None.
        turn: greatest turn of the head, in degrees.
        chick: whether it is drawn young at times.
        ranges: ranges of proportions that differ from the general ones.
    """

    habits: tuple[Annotated[str, tuple(_POSES)], ...]
    body: Profile
    pitch: Range
    neck: Stations
    low: Stations
    skull_size: float
    skull: Profile
    eye: Eyeball
    beak: Stations
    jaw: Stations
    wing: Wing
    tail: Tail
    leg: Legs
    face: Annotated[str, tuple(_FACES)] | None = None
    train: Annotated[str, tuple(_TRAINS)] | None = None
    turn: float = 35.0
    chick: bool = False
    ranges: Mapping[Annotated[str, tuple(_RANGES)], Range] = field(default_factory=dict)

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of one individual in a pose."""
        young = self.chick and pose in {"stand", "walk", "swim"} and bool(rng.uniform() < _YOUNG_SHARE)
        build = proportions(_RANGES, self.ranges, rng, _CHICK if young else None)
        tilt = rng.uniform(*self.pitch)
        tilt = {"soar": 4.0, "swim": 0.6 * tilt, "feed": 0.35 * tilt - 8.0}.get(pose, tilt)
        turn = pitch(tilt)
        middle = turn @ np.array([0.5, 0.0, 0.0])
        body = Frame(-middle, turn)  # the middle of the body at the origin; the legs find the ground

        girth = build["girth"]
        rows = replace(self.body, bottom=self.body.bottom * (0.5 + 0.5 * girth)).wider(girth)
        down = Ripple(0.004, 0.06) if young else None
        parts = [fuse(rows.sweep().placed(body), ripple=down)]
        neck, head = _neck(self, pose, build, body, rng)
        parts.append(replace(neck, ripple=down))
        parts += _head(self, build, head, rng, young)
        out = pose in {"soar", "spread", "land"}
        tail = self.tail
        widest = {"soar": 40.0, "spread": 46.0, "land": 60.0}
        # So that the ends of an open fan touch.
        touching = 2.2 * tail.half_width * (tail.feathers - 1) / (tail.length + 0.16)
        spread = min(widest[pose], float(np.rad2deg(touching))) if out else tail.closed
        feathers = tail_fan(tail, build["tail"], spread * rng.uniform(0.8, 1.2), rng.normal(0, 5))
        if self.train is not None and not young:
            feathers += _TRAINS[self.train](rng, build["tail"])
        if out:
            feathers += opened(self.wing, rows, build["wing"], pose, tilt, rng)
        else:
            feathers += folded(self.wing, rows, build["wing"], young)
        parts += carried(feathers, body)
        if pose != "swim":
            parts += self.leg.grow(build["legs"], pose, body, rng)
        return parts


def _neck(kind: Bird, pose: str, build: Mapping[str, float], body: Frame, rng: Rng) -> tuple[Part, Frame]:
    share = rng.uniform(0.85, 1.0) if pose == "feed" else rng.uniform(0.0, 0.22)
    up, low = kind.neck, kind.low
    points = up.points + share * (low.points - up.points)
    if pose == "soar":  # stretched ahead, or drawn in as a heron does
        points[:, 1] *= 0.25
        points[:, 0] += 0.5 * np.abs(up.y)
    points *= build["neck"]
    points += body.place([0.86, 0.02, 0.0])
    aside = float(np.clip(rng.normal(0, 0.35), -1, 1)) * kind.turn
    bent, _ = bend(points, 0.0, 0.4 * aside)
    radii = up.radius + share * (low.radius - up.radius)
    sweep = tube(bent, radii * np.linspace(1.0, build["head"], len(bent)))
    nod = rng.uniform(-8, 10) - (38.0 * share if pose == "feed" else 0.0)
    return fuse(sweep, blend=0.14), Frame(bent[-1], yaw(aside) @ pitch(nod))


def _head(kind: Bird, build: Mapping[str, float], frame: Frame, rng: Rng, young: bool) -> list[Part]:
    size = kind.skull_size * build["head"]
    parts = [
        fuse(kind.skull.sweep(), blend=0.35),
        fuse(_beak(kind.beak, build["beak"]), blend=0.06),
        fuse(_beak(kind.jaw, build["beak"]), blend=0.02),
        pair(ball(kind.eye.at, kind.eye.radius * (1.2 if young else 1.0))),
    ]
    if kind.face is not None and not young:
        parts += _FACES[kind.face](rng, 1.0)
    return carried(parts, frame, size)


def _beak(rows: Stations, length: float) -> Sweep:
    longer = replace(rows, x=rows.x[0] + (rows.x - rows.x[0]) * length)
    return tube(longer.points, rows.radius, rows.widths)
