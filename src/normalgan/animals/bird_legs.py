"""The legs of birds: a feathered thigh, a thin shank, three toes before and one behind, webbed or not."""

from dataclasses import dataclass

import numpy as np

from normalgan.animals.frames import Floats, Frame, hinge, yaw
from normalgan.animals.parts import Part, by, fuse, in_space, tube
from normalgan.animals.plan import Point, Rng
from normalgan.animals.shapes import Plate, Sweep, rounded

__all__ = ["Legs"]

_TOES = (-34.0, 0.0, 34.0, 180.0)


@dataclass(frozen=True)
class Legs:
    """A pair of legs, in units of the length of the body.

    Args:
        hip: (x, y, z) of the right one in the body's frame.
        thigh: length from hip to heel.
        shank: length from heel to toes.
        thick: radius of the shank.
        meat: radius of the thigh at the hip.
        toe: length of the middle toe.
        web: whether the toes are webbed.
        stance: height of the hip when standing, as a share of the stretched leg.
        claws: radius at the end of a toe, as a share of ``thick``.
    """

    hip: Point
    thigh: float
    shank: float
    thick: float
    meat: float
    toe: float
    web: bool = False
    stance: float = 0.88
    claws: float = 0.5

    def grow(self, factor: float, pose: str, body: Frame, rng: Rng) -> list[Part]:
        """Return both legs in the world; the ground is where those that stand reach to.

        Args:
            factor: on their length.
            pose: stand, walk, feed, perch, one_leg, soar, spread, land.
            body: where the body is.
            rng: draws the stride.
        """
        thigh, shank = self.thigh * factor, self.shank * factor
        stretched = thigh + shank
        x, y, z = self.hip
        middle = body.place([x, y, 0.0])
        high = stretched * (0.62 * self.stance if pose == "perch" else self.stance)
        stride = {"walk": 0.34, "feed": 0.1, "land": 0.06}.get(pose, 0.05) * stretched * rng.uniform(0.6, 1.1)
        side = 1.0 if rng.uniform() < 0.5 else -1.0
        meat: list[Sweep] = []
        feet: list[Part] = []
        for sign in (1.0, -1.0):
            hip = body.place([x, y, sign * z])
            foot = np.array([middle[0] * 0.5 + sign * side * stride, middle[1] - high, sign * z * 0.9])
            heading = 6.0 * sign
            raised = pose == "one_leg" and sign == side
            flat = pose not in {"soar", "land"} and not raised
            if pose == "soar":
                foot = hip + stretched * np.array([-0.82, -0.14, 0.0])
            elif pose == "land":
                foot = hip + stretched * np.array([0.38, -0.72, 0.06 * sign])
            elif raised:
                foot = by(hip, 0.55 * (shank - 0.4 * thigh), -0.55 * thigh, -0.03 * sign)
            elif pose == "one_leg":
                foot[2] *= 0.35
            heel = hinge(hip, foot, thigh, shank, (-1.0, -0.25, 0.0))
            knee = hip + 0.5 * (heel - hip) + np.array([0.12 * thigh, 0.0, 0.0])
            thigh_tube = tube([hip, knee, heel], [self.meat, 0.62 * self.meat, 1.15 * self.thick],
                              [0.8 * self.meat, 0.55 * self.meat, 1.15 * self.thick])  # fmt: skip
            meat.append(thigh_tube.smoothed(3))  # or its kinks would show as rings
            bone = tube([heel, foot], [1.05 * self.thick, 0.95 * self.thick])
            feet.append(fuse(bone, *_toes(self, foot, heading, flat, rng), blend=0.01))
            if self.web:
                feet.append(fuse(_web(self, foot, heading, flat), blend=0.01))
        return [fuse(*meat, blend=0.07), *feet]


def _toes(shape: Legs, foot: Floats, heading: float, flat: bool, rng: Rng) -> list[Sweep]:
    toes = []
    for angle in _TOES:
        length = shape.toe * {0.0: 1.0, 180.0: 0.55}.get(angle, 0.88)
        turn = yaw(heading + angle + rng.normal(0, 3))
        drop = 0.0 if flat else (-0.5 if abs(angle) < 90 else -0.8)
        r = shape.thick
        bones = in_space([(0, 0), (0.35, 0.08 + 0.35 * drop), (0.75, 0.02 + 0.75 * drop), (1.0, drop - 0.03)])
        points = foot + bones * length @ turn.T
        if flat:
            points[:, 1] = np.maximum(points[:, 1], foot[1] - 0.2 * r)
        toes.append(tube(points, [r, 0.85 * r, 0.75 * r, shape.claws * r]))
    return toes


def _web(shape: Legs, foot: Floats, heading: float, flat: bool) -> Plate:
    reach = 0.95 * shape.toe
    tips = [(reach * np.cos(a), reach * np.sin(a)) for a in np.deg2rad([-36, -18, 0, 18, 36])]
    dents = [(0.9 * x, 0.9 * y) if i in {1, 3} else (x, y) for i, (x, y) in enumerate(tips)]
    outline = rounded([(-0.1 * reach, -0.06 * reach), *dents, (-0.1 * reach, 0.06 * reach)], 1)
    lay = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # its axes: x, -z, y
    slope = 0.0 if flat else -0.5
    tilt = np.array([[np.cos(slope), -np.sin(slope), 0], [np.sin(slope), np.cos(slope), 0], [0, 0, 1]])
    return Plate(Frame(foot, yaw(heading) @ tilt @ lay.T), outline, rim=0.6 * shape.thick)
