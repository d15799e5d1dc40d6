"""Tortoises and turtles: a domed shell with grooves between its scutes, legs or flippers, a beaked head."""

from dataclasses import dataclass

import numpy as np

from normalgan.animals.chain import Frame, bend, pitch, yaw
from normalgan.animals.field import Part
from normalgan.animals.forms import ball, both, by, carried, fuse, tube
from normalgan.animals.outline import rounded
from normalgan.animals.plan import Form, Rng
from normalgan.animals.plate import Plate
from normalgan.animals.shapes import factors, trunk
from normalgan.animals.sweep import Floats, Sweep


@dataclass(frozen=True)
class Turtle:
    """A kind of turtle, its shell a unit long.

    Args:
        dome: height of the shell over its rim.
        wide: half the width of the shell.
        clear: height of the rim over the ground.
        neck: length of the neck.
        flippers: whether it swims instead of walking.
        bumpy: how far the scutes bulge.
    """

    dome: float
    wide: float
    clear: float
    neck: float
    flippers: bool = False
    bumpy: float = 0.02


HEAD = (
    (-0.10, 0.07, -0.07, 0.07), (-0.02, 0.105, -0.09, 0.095), (0.07, 0.10, -0.085, 0.088),
        (0.15, 0.055, -0.065, 0.055),
    (0.185, 0.01, -0.06, 0.022),
)  # fmt: skip


def turtle(kind: Turtle) -> Form:
    """Return the body plan of a turtle."""
    poses = ("swim", "swim", "glide") if kind.flippers else ("stand", "walk", "walk", "hide")
    return Form(poses, lambda pose, rng: assemble(kind, pose, rng))


def assemble(kind: Turtle, pose: str, rng: Rng) -> list[Part]:
    """Return the parts of one turtle, in the order in which they blend."""
    build = factors(rng, 0.12, "dome", "wide", "clear", "neck", "head", "legs")
    radii = np.array([0.50, kind.dome * build["dome"], kind.wide * build["wide"]])
    rim = 0.0 if kind.flippers else kind.clear * build["clear"]
    under = 0.28 if kind.flippers else 0.34
    shell = [
        fuse(ball((0, rim, 0), radii)),
        # The dome alone: what lies below its rim is cut off, and a flatter belly set in its place.
        fuse(_slab(rim, radii), carve=True, blend=0.02),
        fuse(ball((0, rim + 0.005, 0), (0.525, 0.045, 1.05 * radii[2])), blend=0.05),
        fuse(ball((0, rim, 0), (0.46, under * radii[1], 0.88 * radii[2])), blend=0.04),
        *([fuse(*_scutes(radii, rim, kind.bumpy), blend=0.25 * radii[1])] if kind.bumpy else []),
        fuse(*_grooves(radii, rim), carve=True, blend=0.008),
    ]
    tail = tube([(-0.40, rim, 0), (-0.52, rim - 0.03, 0), (-0.62, rim - 0.07, 0)], [0.06, 0.04, 0.012])
    parts = [*shell, fuse(tail, blend=0.03)]
    out = kind.neck * build["neck"] * {"hide": 0.35}.get(pose, 1.0)
    stretch = np.array(
        [[0.36, rim - 0.01, 0], [0.48, rim + 0.01, 0], [0.50 + out, rim + 0.10 * (out > 0.1), 0]]
    )
    aside = float(np.clip(rng.normal(0, 16), -35, 35))
    bent, _ = bend(stretch, float(rng.uniform(-10, 22)), aside)
    parts.append(fuse(tube(bent, [0.11, 0.085, 0.07]), blend=0.05))
    head = Frame(bent[-1], yaw(aside) @ pitch(float(rng.uniform(-12, 14))))
    beak = tube([(0.15, 0.0, 0), (0.20, -0.02, 0), (0.205, -0.06, 0)], [0.05, 0.035, 0.012])
    mouth = tube([(0.06, -0.045, 0.092), (0.13, -0.045, 0.066), (0.18, -0.05, 0.028)], 0.007)
    face = [
        fuse(trunk(HEAD), blend=0.03), fuse(beak, blend=0.02), fuse(*both(ball((0.085, 0.045, 0.074),
            0.021))),
        fuse(*both(mouth), carve=True, blend=0.004),
    ]  # fmt: skip
    parts += carried(face, head, 1.15 * build["head"])
    return parts + (_flippers if kind.flippers else _legs)(radii, rim, build["legs"], pose, rng)


def _slab(rim: float, radii: Floats) -> Sweep:
    """Return what lies below the rim of the dome, to be taken away."""
    deep = float(radii[1]) + 0.1
    points = [(-0.8, rim - deep - 0.01, 0.0), (0.8, rim - deep - 0.01, 0.0)]
    return tube(points, deep, 8.0)


def _on(radii: Floats, rim: float, x: float, z: float, out: float = 0.0) -> Floats:
    """Return the point of the dome over (x, z), each a share of its half length or width."""
    y = np.sqrt(max(1 - x * x - z * z, 0.0))
    point: Floats = np.array([0.0, rim, 0.0]) + radii * np.array([x, y, z]) * (1 + out)
    return point


def _scutes(radii: Floats, rim: float, bumpy: float) -> list[Sweep]:
    """Return bulges in the middle of the scutes."""
    bulges = []
    for x in (-0.62, -0.22, 0.20, 0.58):
        bulges.append(_bulge(radii, rim, x, 0.0, bumpy))
    for x in (-0.50, -0.02, 0.44):
        bulges += [_bulge(radii, rim, x, sign * 0.56, bumpy) for sign in (1, -1)]
    return bulges


def _bulge(radii: Floats, rim: float, x: float, z: float, bumpy: float) -> Sweep:
    inner, outer = _on(radii, rim, x, z, -0.10), _on(radii, rim, x, z, bumpy - 0.14)
    return tube([inner, outer], [0.14, 0.07])


def _grooves(radii: Floats, rim: float) -> list[Sweep]:
    """Return the lines between the scutes: a middle row of hexagons between two rows along the flanks."""
    lines = []
    knots = np.array([-0.86, -0.62, -0.42, -0.22, -0.01, 0.20, 0.40, 0.58, 0.82])
    wide = np.array([0.16, 0.34, 0.24, 0.36, 0.25, 0.36, 0.24, 0.32, 0.14])
    for sign in (1, -1):
        edge = [_on(radii, rim, x, sign * w) for x, w in zip(knots, wide, strict=True)]
        lines.append(tube(edge, 0.010))
        for x, w in zip((-0.62, -0.22, 0.20, 0.58), (0.34, 0.36, 0.36, 0.32), strict=True):
            far = 0.93 * np.sqrt(1 - x * x)
            lines.append(tube([_on(radii, rim, x * 1.02, sign * z) for z in np.linspace(w, far, 5)], 0.010))
    for x, w in zip((-0.42, -0.01, 0.40), (0.24, 0.25, 0.24), strict=True):
        lines.append(tube([_on(radii, rim, x, z) for z in np.linspace(-w, w, 5)], 0.010))
    return lines


def _legs(radii: Floats, rim: float, factor: float, pose: str, rng: Rng) -> list[Part]:
    legs, toes = [], []
    for x, fore in ((0.30, True), (-0.32, False)):
        for sign in (1.0, -1.0):
            step = float(rng.uniform(0.06, 0.12)) * sign * (1 if fore else -1) if pose == "walk" else 0.0
            z = sign * radii[2] * 0.66
            foot = np.array([x + step + (0.07 if fore else -0.05), 0.06, 1.16 * z])
            knee = np.array([x + 0.5 * step + (0.05 if fore else -0.06), 0.5 * rim + 0.04, 1.14 * z])
            legs.append(
                tube(np.array([[x, rim, z * 0.8], knee, foot]), [0.12, 0.10 * factor, 0.085 * factor])
            )
            for spread in (-0.05, 0.0, 0.05):
                tip = by(foot, 0.085, -0.035, spread)
                toes.append(tube([by(foot, 0.04, -0.03, spread), tip], [0.035, 0.022]))
    return [fuse(*legs, blend=0.03), fuse(*toes, blend=0.03)]


def _flippers(radii: Floats, rim: float, factor: float, pose: str, rng: Rng) -> list[Part]:
    parts = []
    lift = float(rng.uniform(-28, 34)) if pose == "swim" else float(rng.uniform(-8, 6))
    fore = rounded([(0.0, 0.08), (0.20, 0.11), (0.42, 0.0), (0.66, -0.24), (0.68, -0.30), (0.44, -0.20),
        (0.16, -0.09),
                    (0.0, -0.08)])  # fmt: skip
    hind = rounded([(0.0, 0.06), (0.16, 0.05), (0.28, -0.06), (0.26, -0.12), (0.12, -0.10), (0.0, -0.06)])
    for outline, x, sweep, up in ((fore, 0.30, 8.0, lift), (hind, -0.36, 52.0, -0.4 * lift)):
        out, rise = np.deg2rad(sweep), np.deg2rad(up)
        first = np.array([-np.sin(out) * np.cos(rise), np.sin(rise), np.cos(out) * np.cos(rise)])
        second = np.array([1.0, 0.0, 0.0]) - first[0] * first
        second /= np.linalg.norm(second)
        frame = Frame(
            np.array([x, rim - 0.02, 0.74 * radii[2]]),
            np.column_stack([first, second, np.cross(first, second)]),
        )
        right = Plate(outline * factor, frame, 0.016, 0.25, 0.05)
        parts.append(fuse(right, right.mirrored(), blend=0.05))
    return parts
