"""What a species is: stations, attachments and ranges, in units of the height at the withers."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np

from normalgan.animals.template import LegTemplate

Row = tuple[float, ...]
Range = tuple[float, float]


@dataclass(frozen=True)
class Build:
    """Factors by which an individual differs from the drawing of its species; 1 is the drawing.

    Args:
        length: of the torso.
        depth: of the belly, measured down from the back.
        girth: width of the torso.
        legs: length of the legs.
        bone: thickness of the legs.
        neck: length of the neck.
        crest: thickness of the neck.
        head: size of the head.
        muzzle: length of the face before the eyes.
        ears: length of the ears.
        horns: length of horns, antlers, tusks.
        tail: length of the tail.
        humps: height of humps.
    """

    length: float = 1.0
    depth: float = 1.0
    girth: float = 1.0
    legs: float = 1.0
    bone: float = 1.0
    neck: float = 1.0
    crest: float = 1.0
    head: float = 1.0
    muzzle: float = 1.0
    ears: float = 1.0
    horns: float = 1.0
    tail: float = 1.0
    humps: float = 1.0


RANGES: Mapping[str, Range] = {
    "length": (0.93, 1.07),
    "depth": (0.92, 1.08),
    "girth": (0.9, 1.15),
    "legs": (0.93, 1.07),
    "bone": (0.9, 1.15),
    "neck": (0.92, 1.1),
    "crest": (0.92, 1.12),
    "head": (0.94, 1.08),
    "muzzle": (0.92, 1.08),
    "ears": (0.85, 1.2),
    "horns": (0.75, 1.25),
    "tail": (0.85, 1.15),
    "humps": (0.8, 1.2),
}
YOUNG: Mapping[str, float] = {
    "legs": 1.08, "bone": 0.95, "girth": 0.88, "depth": 0.86, "length": 0.9, "head": 1.12, "muzzle": 0.88,
    "neck": 0.92, "ears": 1.1, "horns": 0.35, "tail": 0.8,
}  # fmt: skip


def draw_build(ranges: Mapping[str, Range], young: bool, rng: np.random.Generator) -> Build:
    """Draw each factor evenly from its range, the species' own or else the general one."""
    drawn = {}
    for part in fields(Build):
        low, high = ranges.get(part.name, RANGES[part.name])
        drawn[part.name] = float(rng.uniform(low, high)) * (YOUNG.get(part.name, 1.0) if young else 1.0)
    return Build(**drawn)


@dataclass(frozen=True)
class Limb:
    """A pair of legs.

    Args:
        template: their shape.
        x: of the uppermost joint, forward.
        y: of the uppermost joint, above the ground.
        z: of the uppermost joint, from the middle.
        foot: z of the foot.
        thick: factor on the template's radii.
    """

    template: LegTemplate
    x: float
    y: float
    z: float
    foot: float
    thick: float = 1.0


@dataclass(frozen=True)
class Ornament:
    """Something on the body or head: ear, horn, eye, hump.

    Args:
        rows: stations (x, y, z, radius, width); on the head in units of its length.
        scale: the factor of `Build` that stretches it from its pivot.
        side: direction of the width.
        mirror: whether there is another on the left.
        blend: width of the blend.
        carve: dig instead of add.
        cut: flatten the end, across the last span.
        swivel: degrees by which its direction may differ from one individual to the next.
        chance: share of the individuals that have it.
        ripple: height and wavelength of bumps, or None.
        pivot: what it is stretched and swivelled about; None for its first station.
        otherwise: it is there if the one before it is not, whatever its chance.
    """

    rows: tuple[Row, ...]
    scale: str = "head"
    side: tuple[float, float, float] = (0.0, 0.0, 1.0)
    mirror: bool = True
    blend: float = 0.01
    carve: bool = False
    cut: bool = False
    swivel: float = 0.0
    chance: float = 1.0
    ripple: tuple[float, float] | None = None
    pivot: tuple[float, float, float] | None = None
    otherwise: bool = False


@dataclass(frozen=True)
class Head:
    """The skull and what grows on it, in the head's own frame: x to the nose, y up, origin at the poll.

    Args:
        length: of the head.
        pitch: degrees by which the face points up (negative: down) at rest.
        rows: stations (x, top, bottom, half width) in units of the length.
        ornaments: ears, horns, nose.
        eye: (x, degrees above the middle of the side, radius) of the eyes on the skull.
        mouth: (x of its corner, degrees above the middle of the side, negative below), or None.
        flat: whether the snout ends flat.
    """

    length: float
    pitch: float
    rows: tuple[Row, ...]
    ornaments: tuple[Ornament, ...]
    eye: tuple[float, float, float]
    mouth: tuple[float, float] | None = None
    flat: bool = False


@dataclass(frozen=True)
class Species:
    """A kind of quadruped, standing at rest, head to +x, ground at y = 0.

    Args:
        torso: stations (x, top, bottom, half width) from the buttocks to the breast.
        neck: stations (x, y, radius, half width) from inside the chest to the poll.
        head: the head.
        fore: the forelegs.
        hind: the hind legs.
        tail: stations (x, y, radius) from inside the croup to the tip.
        poses: names of the poses it is seen in.
        ornaments: humps and udders, in the body's frame.
        mane: (height over the neck's spine in neck radii, radius, half width, how far aside it falls in neck
            widths, height of its bumps) of a crest, or None.
        ranges: those ranges of `Build` that differ from the general ones.
        tail_lift: degrees between which the tail is raised.
        tail_ripple: bumps on the tail, or None.
        coat: bumps on torso and neck, or None.
        ruff: bumps on the neck if others than the coat's.
        neck_pitch: degrees between which the neck is raised over its rest.
    """

    torso: tuple[Row, ...]
    neck: tuple[Row, ...]
    head: Head
    fore: Limb
    hind: Limb
    tail: tuple[Row, ...]
    poses: tuple[str, ...]
    ornaments: tuple[Ornament, ...] = ()
    mane: tuple[float, float, float, float, float] | None = None
    ranges: Mapping[str, Range] = field(default_factory=dict)
    tail_lift: Range = (-10.0, 25.0)
    tail_ripple: tuple[float, float] | None = None
    coat: tuple[float, float] | None = None
    ruff: tuple[float, float] | None = None
    neck_pitch: Range = (-15.0, 12.0)
