"""Fish: proportions of a species in body lengths, with parts that follow a bent spine."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from normalgan.animals.frames import spanned, unit
from normalgan.animals.parts import Part, ball, fuse, tube
from normalgan.animals.plan import Eyeball, PosedPlan, Rng, proportions
from normalgan.animals.shapes import MIRROR, Plate, Sweep, rounded
from normalgan.animals.stations import Profile, Spine
from normalgan.animals.tables import Kinds, Number, Point, Span, Table
from normalgan.arrays import Doubles
from normalgan.errors import InputError
from normalgan.ranges import OneOf, Range

_RANGES: Mapping[str, Span] = {
    "depth": (0.85, 1.18), "girth": (0.85, 1.2), "fins": (0.8, 1.25), "tail": (0.85, 1.2),
    "eye": (0.85, 1.25),
}  # fmt: skip
_POSES = ("glide", "swim", "turn")


@dataclass(frozen=True)
class Fin(Table):
    """A fin in the sagittal plane, or a pair of them.

    Args:
        outline: corners (x, y) in body lengths; for a pair of fins, outwards from the root and along the
            chord.
        thick: half thickness at the rim.
        root: (x, y, z) of the root of a pair; None for a single fin in the fish's own coordinates.
        spread: angle in degrees between a pair of fins and the flank; 90 is straight out.
        droop: downward angle of a pair in degrees.
        chord: direction of a pair's second axis, before it is made perpendicular to the first.
        swell: increase of the half thickness per distance from the rim.
        sharp: whether the corners of the outline are cut once instead of twice.

    Raises:
        InputError: if the outline has fewer than three corners, or the chord is zero.
    """

    outline: tuple[tuple[Number, Number], ...]
    thick: Number = 0.007
    root: Point | None = None
    spread: Number = 50.0
    droop: Number = 20.0
    chord: Point = (1.0, 0.0, 0.0)
    swell: Number = 0.08
    sharp: bool = False

    def __post_init__(self) -> None:
        """Check the outline and the chord."""
        if len(self.outline) < 3:
            raise InputError(f"outline has three corners or more, not {len(self.outline)}.")
        if not any(self.chord):
            raise InputError("chord is a direction, and 0, 0, 0 is none.")


def _finlet(x: Number, height: Number, below: bool = False) -> Fin:
    """Return a finlet, one of a row of small fins in the sagittal plane in front of the tail.

    Args:
        x: position along the body.
        height: height of its root above the middle of the body.
        below: whether the finlet is on the belly instead of the back.
    """
    side = -1.0 if below else 1.0
    corners = ((-0.02, 0.0), (-0.035, 0.035), (-0.01, 0.03), (0.025, 0.0))
    return Fin(tuple((x + ahead, side * (height + up)) for ahead, up in corners), sharp=True)


@dataclass(frozen=True)
class Gills(Table):
    """Slits, or the groove of a gill cover, on both flanks.

    Args:
        x: x of the first slit.
        y: y of its centre.
        z: z of the right flank.
        height: height of a slit.
        slits: number of slits.
        lid: whether there is a gill cover with a single curved groove.
    """

    x: Number
    y: Number
    z: Number
    height: Number
    slits: Annotated[int, Range(0, 20)] = 0
    lid: bool = False


@dataclass(frozen=True)
class Fish(PosedPlan):
    """A kind of fish in a straight pose, with the nose at x = 1 and the root of the tail fin near x = 0.

    Args:
        body: stations from the tail to the nose.
        fins: all fins except the tail fin, in blending order.
        eye: right eye.
        mouth: points of the right half of the mouth, from the corner to the middle.
        gills: gills on both flanks.
        tail: upright tail fin, or None.
        spines: number of spines on the skin.
        wave: amplitude in degrees of body and tail when swimming.
        ranges: ranges of proportions that differ from the defaults.

    Raises:
        InputError: if the mouth has fewer than two points.
    """

    habits: tuple[Annotated[str, OneOf(_POSES)], ...]
    body: Profile
    fins: tuple[Annotated[Fin, Kinds(fin=Fin, finlet=_finlet)], ...]
    eye: Eyeball
    mouth: tuple[Point, ...]
    gills: Gills
    tail: Fin | None = None
    spines: Annotated[int, Range(0, 500)] = 0
    wave: Number = 26.0
    ranges: Mapping[Annotated[str, OneOf(_RANGES)], Span] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the mouth."""
        if len(self.mouth) < 2:
            raise InputError("mouth is a line of two points or more.")

    def assemble(self, pose: str, rng: Rng) -> list[Part]:
        """Return the parts of a random individual in a pose."""
        build = proportions(_RANGES, self.ranges, rng)
        spine = _spine(pose, self.wave, rng)
        depth, girth = build["depth"], build["girth"]
        stretch = np.array([1.0, depth, girth])
        body = replace(self.body, top=self.body.top * depth, bottom=self.body.bottom * depth).wider(girth)
        parts = [fuse(spine.sweep(body))]
        if self.tail is not None:
            parts.append(fuse(*_plates(self.tail, spine, build["tail"]), blend=0.03))
        flare, flap = rng.normal(0, 7), rng.normal(0, 7)
        for each in self.fins:
            moved = _moved(each, stretch)
            parts.append(fuse(*_plates(moved, spine, build["fins"], flare, flap), blend=0.018))
        eyes = np.array(_halves(np.array(self.eye.at))) * stretch
        eyes[:, 2] -= 0.35 * self.eye.radius * np.sign(eyes[:, 2])
        parts.append(fuse(*(ball(at, self.eye.radius * build["eye"]) for at in spine.place(eyes))))
        if self.spines:
            parts.append(fuse(*_spines(body, self.spines, spine), blend=0.02))
        return [*parts, *_grooves(self, spine, stretch)]


def _spine(pose: str, wave: float, rng: Rng) -> Spine:
    xs = np.linspace(-0.1, 1.0, 23)
    behind = 1.0 - xs
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    size = rng.uniform(0.5, 1.0) * side * wave
    if pose == "swim":  # a travelling wave with increasing amplitude towards the tail
        turns = size * behind**1.4 * np.sin(2 * np.pi * (0.8 * behind + rng.uniform()))
    elif pose == "turn":
        turns = 1.5 * size * behind**1.2
    else:
        turns = 0.12 * size * behind
    return Spine(xs, turns - turns[-1])


def _moved(fin: Fin, stretch: Doubles) -> Fin:
    """Return a fin moved with the stretched back, belly or flank that it is attached to."""
    if fin.root is not None:
        x, y, z = np.array(fin.root) * stretch
        return replace(fin, root=(float(x), float(y), float(z)))
    shift = min(abs(y) for _, y in fin.outline) * (stretch[1] - 1.0)
    return replace(fin, outline=tuple((x, y + float(np.sign(y)) * shift) for x, y in fin.outline))


def _spines(body: Profile, count: int, spine: Spine) -> list[Sweep]:
    """Return spines all around the body, distributed by the golden angle."""
    spines = []
    for i in range(count):
        x = 0.18 + 0.64 * (i + 0.5) / count
        top, bottom, wide = body.at(x)
        angle = i * np.pi * (3 - np.sqrt(5))
        out = np.array([0.0, (top - bottom) / 2 * np.sin(angle), wide * np.cos(angle)])
        root = np.array([x, (top + bottom) / 2, 0.0]) + 0.97 * out
        tip = root + 0.085 * (unit(out) + np.array([1.2 * (x - 0.55), 0.0, 0.0]))
        spines.append(tube(spine.place(np.array([root, tip])), [0.022, 0.004]))
    return spines


# From top to bottom of the right side: in body lengths along and across, in slit heights upwards.
_SLIT = np.array([(0.010, 0.5, -0.012), (-0.004, 0.0, 0.0), (0.010, -0.5, -0.012)])
_LID = np.array([(0.05, 0.50, -0.022), (0.012, 0.34, -0.008), (0.0, 0.0, 0.0), (0.02, -0.36, -0.012),
                 (0.07, -0.55, -0.03)])  # fmt: skip


def _grooves(kind: Fish, spine: Spine, stretch: Doubles) -> list[Part]:
    """Return mouth and gills, to be subtracted."""
    gills = kind.gills
    height = gills.height

    def grooves(line: Doubles, radius: float) -> list[Sweep]:
        return [tube(spine.place(half), radius) for half in _halves(line)]

    lines = grooves(np.array(kind.mouth) * stretch, 0.008)
    slits = []
    for i in range(gills.slits):
        at = np.array([gills.x - 0.022 * i, gills.y, gills.z]) * stretch
        slits += grooves(at + _SLIT * [1, height, 1], 0.007)
    if gills.lid:
        slits += grooves(np.array([gills.x, gills.y, gills.z]) * stretch + _LID * [1, height, 1], 0.009)
    parts = [fuse(*lines, blend=0.006, carve=True)]
    return [*parts, fuse(*slits, blend=0.006, carve=True)] if slits else parts


def _halves(points: Doubles) -> tuple[Doubles, Doubles]:
    return points, points * MIRROR


def _plates(
    fin: Fin, spine: Spine, factor: float = 1.0, flare: float = 0.0, flap: float = 0.0
) -> list[Plate]:
    """Return the plates of a fin, scaled in height by ``factor``; ``flare`` and ``flap`` rotate a pair."""
    corners = np.array(fin.outline)
    times = 1 if fin.sharp else 2
    if fin.root is None:
        middle = float(corners[:, 0].mean())
        base = float(np.abs(corners[:, 1]).min()) * np.sign(corners[:, 1].sum())
        flat = rounded([(x - middle, base + (y - base) * factor) for x, y in corners], times)
        # The plate bends like the spine at its centre.
        h = 0.05
        before, after = (spine.frame(middle + d).rotation for d in (-h, h))
        turn = float(np.arctan2(-after[2, 0], after[0, 0]) - np.arctan2(-before[2, 0], before[0, 0]))
        return [Plate(spine.frame(middle), flat, fin.thick, fin.swell, 4 * fin.thick, (-turn / (2 * h), 0.0))]
    x, y, z = fin.root
    out, drop = np.deg2rad(fin.spread + flare), np.deg2rad(fin.droop + flap)
    first = np.array([-np.cos(out) * np.cos(drop), -np.sin(drop), np.sin(out) * np.cos(drop)])
    frame = spanned(np.array([0.0, y, z]), first, np.array(fin.chord))
    outline = rounded([(a * factor, b) for a, b in corners], times)
    right = Plate(frame, outline, fin.thick, fin.swell, 4 * fin.thick)
    return [each.placed(spine.frame(x)) for each in (right, right.mirrored())]
