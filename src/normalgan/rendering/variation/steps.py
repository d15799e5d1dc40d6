"""The deformations that make a variant of an object, in order."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.variation.bending import Deformation, Deformed, bend, scale, taper, together, twist
from normalgan.rendering.variation.draws import PARTS, VariationDraws
from normalgan.rendering.variation.lattice import free_form
from normalgan.rendering.variation.limbs import Middle, belly, lengthen, thicken
from normalgan.rendering.variation.local import bump, swell
from normalgan.rendering.variation.variation import Variation

__all__ = ["BUMP_WIDTH", "LIMB_WIDTH", "MIRROR", "PART_WIDTH", "Object", "steps"]

LIMB_WIDTH = 0.06
"""Standard deviation of the Gaussian that finds the middle of limbs, in radii of the object."""
PART_WIDTH = (0.16, 0.35)
BUMP_WIDTH = (0.06, 0.2)
MIRROR = np.array([1.0, 1.0, -1.0])


class Object:
    """A surface in the coordinates of its frame, with the measures that deformations need.

    Args:
        points: (V, 3) vertices; the third coordinate is sideways.
        normals: (V, 3) of the surface.
        areas: (V,) area of the surface around each vertex.
        faces: (F, 3) vertex indices.
        up: the axis that points up.
    """

    def __init__(
        self, points: Doubles, normals: Doubles, areas: Doubles, faces: NDArray[np.integer], up: int
    ) -> None:
        self.points, self.normals, self.up = points, normals, up
        self.belly = belly(points, faces, up)
        self.limbs = Middle.of(points, areas, LIMB_WIDTH)
        self.trunk = Middle.of(points, areas, float(np.mean(PART_WIDTH)))
        self._cumulated = np.cumsum(areas) / areas.sum()

    def vertices_at(self, shares: Doubles) -> Indices:
        """Return the vertices at the given shares, from 0 to 1, of the accumulated surface."""
        return np.searchsorted(self._cumulated, shares).clip(0, len(self.points) - 1)


def steps(thing: Object, strength: Variation, draws: VariationDraws) -> list[Deformation]:
    """Return the deformations of one variation, in order.

    Args:
        thing: the object.
        strength: how much the draws count.
        draws: the random draws.
    """
    odd = strength.asymmetry
    half = float(np.abs(thing.points[:, 0]).max())
    length, thickness = draws.limbs * [strength.limb_length, strength.limb_thickness]
    up, sideways = np.deg2rad(strength.bend) * draws.bend * [1.0, odd] / (2 * half)
    # Steps that are placed on the surface come first, before it moves.
    return [
        partial(thicken, middle=thing.limbs, growth=float(thickness)),
        partial(together, deformations=_parts(thing, strength, draws)),
        partial(together, deformations=_bumps(thing, strength, draws)),
        partial(lengthen, up=thing.up, line=thing.belly, growth=float(length)),
        partial(scale, factors=(1 + strength.scale) ** draws.scale),
        partial(taper, slope=strength.taper * draws.taper / half),
        partial(_pull, pulls=_mirrored(strength.lattice * draws.lattice, odd)),
        partial(twist, rate=float(np.deg2rad(strength.twist) * odd * draws.twist / (2 * half))),
        partial(bend, curvature=float(up), across=1),
        partial(bend, curvature=float(sideways), across=2),
    ]


def _parts(thing: Object, strength: Variation, draws: VariationDraws) -> list[Deformation]:
    """Return the growth of parts, each with its mirror image; centres lie under the skin."""
    centres, _ = thing.trunk.at(thing.points[thing.vertices_at(draws.part_places)])
    widths = PART_WIDTH[0] + draws.widths[:PARTS] * (PART_WIDTH[1] - PART_WIDTH[0])
    found: list[Deformation] = []
    for centre, width, growth in zip(centres, widths, strength.parts * draws.parts, strict=True):
        own, other = _sides(centre, float(width), strength.asymmetry)
        found.append(partial(swell, centre=centre, width=width, growth=own * growth))
        found.append(partial(swell, centre=centre * MIRROR, width=width, growth=other * growth))
    return found


def _bumps(thing: Object, strength: Variation, draws: VariationDraws) -> list[Deformation]:
    """Return the bumps and hollows, along the normal, each with its mirror image."""
    vertices = thing.vertices_at(draws.bump_places)
    widths = BUMP_WIDTH[0] + draws.widths[PARTS:] * (BUMP_WIDTH[1] - BUMP_WIDTH[0])
    found: list[Deformation] = []
    for vertex, width, height in zip(vertices, widths, strength.bumps * draws.bumps, strict=True):
        centre, shift = thing.points[vertex], height * width * thing.normals[vertex]
        own, other = _sides(centre, float(width), strength.asymmetry)
        found.append(partial(bump, centre=centre, width=width, shift=own * shift))
        found.append(partial(bump, centre=centre * MIRROR, width=width, shift=other * shift * MIRROR))
    return found


def _sides(centre: Doubles, width: float, odd: float) -> tuple[float, float]:
    """Return the weights of a change and of its mirror image, half each in the middle, where they meet."""
    both = 1 + (1 - odd) * float(np.exp(-((centre[2] / width) ** 2)))
    return 1 / both, (1 - odd) / both


def _mirrored(pulls: Doubles, odd: float) -> Doubles:
    """Return the pulls of a lattice with this share of the difference between left and right."""
    image = pulls[:, :, ::-1] * MIRROR
    # The mean of two independent pulls is smaller by √2.
    return np.asarray(((pulls + image) + odd * (pulls - image)) / np.sqrt(2 * (1 + odd**2)))


def _pull(points: Doubles, pulls: Doubles) -> Deformed:
    """Deform by a lattice about the points, as wide to the left as to the right."""
    low, high = points.min(axis=0), points.max(axis=0)
    high[2] = max(-low[2], high[2])
    low[2] = -high[2]
    return free_form(points, low, high, pulls * (high - low))
