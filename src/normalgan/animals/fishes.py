"""What a kind of fish is, in units of its length, and how its parts come together along a bent spine."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.fins import Fin, grow
from normalgan.animals.forms import ball, fuse, tube
from normalgan.animals.plan import Form, Rng
from normalgan.animals.shapes import Rows
from normalgan.animals.spine import Spine
from normalgan.animals.sweep import Floats, Sweep

Range = tuple[float, float]


@dataclass(frozen=True)
class Fish:
    """A kind of fish, straight, its nose at x = 1, the root of its tail fin near x = 0.

    Args:
        body: stations (x, top, bottom, half width) from the tail to the nose.
        fins: all fins but that of the tail.
        tail: the tail fin, upright, or None.
        eye: (x, y, z, radius).
        mouth: stations (x, y, z) of its right half, from the corner to the middle in front.
        gills: (x, y, z, height, number) of the slits on the right flank; number 0 for none.
        lid: whether a gill cover shows as one curved groove instead.
        spines: how many spines stand off its skin.
        wave: degrees by which body and tail swing when it swims.
        poses: the poses it is drawn in.
        ranges: ranges of proportions that differ from the general ones.
    """

    body: Rows
    fins: tuple[Fin, ...]
    tail: Fin | None
    eye: tuple[float, float, float, float]
    mouth: Rows
    gills: tuple[float, float, float, float, int]
    lid: bool = False
    spines: int = 0
    wave: float = 26.0
    poses: tuple[str, ...] = ("glide", "swim", "swim", "turn")
    ranges: Mapping[str, Range] = field(default_factory=dict)


RANGES: Mapping[str, Range] = {
    "depth": (0.85, 1.18), "girth": (0.85, 1.2), "fins": (0.8, 1.25), "tail": (0.85, 1.2),
    "eye": (0.85, 1.25),
}  # fmt: skip


def fish(kind: Fish) -> Form:
    """Return the body plan of a kind of fish."""
    return Form(kind.poses, lambda pose, rng: assemble(kind, pose, rng))


def assemble(kind: Fish, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one fish, in the order in which they blend."""
    build = {name: float(rng.uniform(*kind.ranges.get(name, RANGES[name]))) for name in RANGES}
    spine = _spine(pose, kind.wave, rng)
    stretch = np.array([1.0, build["depth"], build["girth"]])
    rows = np.array(kind.body)
    rows[:, 1:3] *= build["depth"]
    rows[:, 3] *= build["girth"]
    parts = [fuse(spine.trunk(rows))]
    if kind.tail is not None:
        parts.append(fuse(*grow(kind.tail, spine, build["tail"]), blend=0.03))
    flare, flap = float(rng.normal(0, 7)), float(rng.normal(0, 7))
    for each in kind.fins:
        parts.append(fuse(*grow(_moved(each, stretch), spine, build["fins"], flare, flap), blend=0.018))
    x, y, z, radius = kind.eye
    eyes = np.array([[x, y, z], [x, y, -z]]) * stretch
    eyes[:, 2] -= 0.35 * radius * np.sign(eyes[:, 2])
    parts.append(fuse(*(ball(at, radius * build["eye"]) for at in spine.place(eyes))))
    if kind.spines:
        parts.append(fuse(*_spines(rows, kind.spines, spine), blend=0.02))
    return [*parts, *_grooves(kind, spine, stretch)]


def _spine(pose: str, wave: float, rng: Rng) -> Spine:
    xs = np.linspace(-0.1, 1.0, 23)
    behind = 1.0 - xs
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    size = float(rng.uniform(0.5, 1.0)) * side * wave
    if pose == "swim":  # a travelling wave that grows towards the tail
        turns = size * behind**1.4 * np.sin(2 * np.pi * (0.8 * behind + float(rng.uniform())))
    elif pose == "turn":
        turns = 1.5 * size * behind**1.2
    else:
        turns = 0.12 * size * behind
    return Spine(xs, turns - turns[-1])


def _moved(fin: Fin, stretch: Floats) -> Fin:
    """Return a fin moved out with the back, belly or flank it stands on."""
    if fin.root is not None:
        x, y, z = np.array(fin.root) * stretch
        return replace(fin, root=(float(x), float(y), float(z)))
    shift = min(abs(y) for _, y in fin.outline) * (stretch[1] - 1.0)
    return replace(fin, outline=tuple((x, y + float(np.sign(y)) * shift) for x, y in fin.outline))


def _spines(rows: Floats, count: int, spine: Spine) -> list[Sweep]:
    """Return spines all round, spread by the golden angle."""
    spines = []
    for i in range(count):
        x = 0.18 + 0.64 * (i + 0.5) / count
        top, bottom, wide = (float(np.interp(x, rows[:, 0], column)) for column in rows.T[1:])
        angle = i * np.pi * (3 - np.sqrt(5))
        out = np.array([0.0, (top - bottom) / 2 * np.sin(angle), wide * np.cos(angle)])
        root = np.array([x, (top + bottom) / 2, 0.0]) + 0.97 * out
        tip = root + 0.085 * (out / np.linalg.norm(out) + [1.2 * (x - 0.55), 0.0, 0.0])
        spines.append(tube(spine.place(np.array([root, tip])), [0.022, 0.004]))
    return spines


def _grooves(kind: Fish, spine: Spine, stretch: Floats) -> list[Part]:
    """Return mouth and gills, to dig."""
    x, y, z, height, number = kind.gills
    lines = [tube(spine.place(half), 0.008) for half in _halves(np.array(kind.mouth) * stretch)]
    slits = []
    for i in range(number):
        at = np.array([x - 0.022 * i, y, z]) * stretch
        slit = at + np.array([[0.010, 0.5, -0.012], [-0.004, 0.0, 0.0], [0.010, -0.5, -0.012]]) * [
            1,
            height,
            1,
        ]
        slits += [tube(spine.place(half), 0.007) for half in _halves(slit)]
    if kind.lid:
        at = np.array([x, y, z]) * stretch
        curve = np.array([[0.05, 0.50, -0.022], [0.012, 0.34, -0.008], [0.0, 0.0, 0.0], [0.02, -0.36, -0.012],
                          [0.07, -0.55, -0.03]])  # fmt: skip
        slits += [tube(spine.place(half), 0.009) for half in _halves(at + curve * [1, height, 1])]
    parts = [fuse(*lines, blend=0.006, carve=True)]
    return [*parts, fuse(*slits, blend=0.006, carve=True)] if slits else parts


def _halves(points: Floats) -> tuple[Floats, Floats]:
    return points, points * np.array([1.0, 1.0, -1.0])
