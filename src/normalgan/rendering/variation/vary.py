"""vary, which returns a random variant of a mesh with its normals, and Varied, a variant as a mesh source."""

import hashlib
import json
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import Doubles, Indices
from normalgan.ranges import Count, check_ranges
from normalgan.rendering.mesh import Mesh, MeshSource
from normalgan.rendering.variation.deformations import (
    Deformation,
    Deformed,
    Middle,
    belly,
    bend,
    bump,
    free_form,
    in_turn,
    lengthen,
    scale,
    swell,
    taper,
    thicken,
    together,
    twist,
)
from normalgan.rendering.variation.frame import find_frame
from normalgan.rendering.variation.joints import find_limb_joints
from normalgan.rendering.variation.variation import Variation
from normalgan.seeds import rng_of

_LEAST_VOLUME = 0.1
"""Minimum volume factor at a vertex; deformations that shrink space more, or invert it, are too strong."""


def vary(mesh: Mesh, variation: Variation, rng: np.random.Generator) -> Mesh:
    """Return a random variant of a mesh, like another individual of the same species.

    Normals are transformed exactly, by the inverse transpose of the deformation's Jacobian, so sharp edges
    stay sharp. If the deformation would turn the surface inside out, all strengths are halved until it
    does not.

    Args:
        mesh: original mesh, returned unchanged if all strengths are 0.
        variation: strengths of the variation.
        rng: source of randomness. The strengths affect only the amount of the changes, not the random
            draws.
    """
    if variation.none():
        return mesh
    limbs, lean = rng.spawn(2)
    if variation.joints:
        mesh = _bend_limbs(mesh, np.deg2rad(variation.joints), limbs)
    frame = find_frame(mesh)
    points = frame.inward(mesh.vertices.astype(np.float64))
    normals = mesh.normals.astype(np.float64) @ frame.axes.T
    thing = _Object(points, normals, frame.areas, mesh.faces, frame.up)
    amount = 1.0
    while True:
        moved, jacobian = in_turn(points, _steps(thing, variation.times(amount), deepcopy(rng)))
        turned = _cofactors(jacobian)
        if _holds(jacobian, turned):
            break
        amount /= 2  # terminates, because the Jacobian is the identity for strength 0
    turned_normals = np.einsum("vij,vj->vi", turned, normals) @ frame.axes
    turned_normals /= np.linalg.norm(turned_normals, axis=1, keepdims=True)
    vertices = frame.outward(moved)
    if variation.tilt:
        turn = _lean(np.deg2rad(variation.tilt), lean)
        vertices, turned_normals = vertices @ turn.T, turned_normals @ turn.T
    vertices -= (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    vertices /= np.linalg.norm(vertices, axis=1).max()
    return Mesh(mesh.name, vertices.astype(np.float32), mesh.faces, turned_normals.astype(np.float32))


def _bend_limbs(mesh: Mesh, most: float, rng: np.random.Generator) -> Mesh:
    """Return the mesh with the joints of its limbs rotated by up to ``most`` radians about random axes."""
    points, normals = mesh.vertices.astype(np.float64), mesh.normals.astype(np.float64)
    for joint in find_limb_joints(points, mesh.faces, rng):
        axis = np.cross(joint.outward, rng.standard_normal(3))
        axis /= np.linalg.norm(axis)
        angle = float(rng.uniform(-most, most))
        moved, jacobian = joint.bend(points, axis, angle)
        turned = _cofactors(jacobian)
        if _holds(jacobian, turned):
            points, normals = moved, np.einsum("vij,vj->vi", turned, normals)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return replace(mesh, vertices=points.astype(np.float32), normals=normals.astype(np.float32))


def _holds(jacobian: Doubles, turned: Doubles) -> bool:
    """Return whether a deformation preserves enough volume at each vertex, given cofactors ``turned``."""
    volume = np.einsum(
        "vc,vc->v", jacobian[:, 0], turned[:, 0]
    )  # a row times its cofactors is the determinant
    return bool(volume.min() >= _LEAST_VOLUME)


def _lean(most: float, rng: np.random.Generator) -> Doubles:
    """Return a rotation (3, 3) about a horizontal axis by up to ``most`` radians, preferring small angles."""
    from scipy.spatial.transform import Rotation  # takes half a second to import, only needed to vary meshes

    heading = rng.uniform(0.0, 2 * np.pi)
    angle = most * rng.uniform() ** 3
    axis = np.array([np.cos(heading), 0.0, np.sin(heading)])
    return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix())


def _cofactors(matrices: Doubles) -> Doubles:
    """Return the cofactors (V, 3, 3) of matrices (V, 3, 3): determinant times inverse transpose.

    >>> _cofactors(np.diag([2.0, 1.0, 1.0])[None])[0].diagonal()
    array([1., 2., 2.])
    """
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)


_LIMB_WIDTH = 0.06
"""Standard deviation of the Gaussian for the middle of limbs, in radii of the object."""
_PARTS, _PART_WIDTH = 3, (0.16, 0.35)
_BUMPS, _BUMP_WIDTH = 12, (0.06, 0.2)
"""Number of growing parts and number of bumps, each with minimum and maximum width."""
_MIRROR = np.array([1.0, 1.0, -1.0])


class _Object:
    """A surface in the coordinates of its frame, with measurements for the deformations.

    Args:
        points: (V, 3) vertices; the third coordinate is sideways.
        normals: (V, 3) normals of the surface.
        areas: (V,) area of the surface around each vertex.
        faces: (F, 3) vertex indices.
        up: index of the axis that points up.
    """

    def __init__(
        self, points: Doubles, normals: Doubles, areas: Doubles, faces: NDArray[np.integer], up: int
    ) -> None:
        self.points, self.normals, self.up = points, normals, up
        self.belly = belly(points, faces, up)
        self.limbs = Middle.of(points, areas, _LIMB_WIDTH)
        self.trunk = Middle.of(points, areas, float(np.mean(_PART_WIDTH)))
        self._cumulated = np.cumsum(areas) / areas.sum()

    def vertices_at(self, shares: Doubles) -> Indices:
        """Return the vertices at the given fractions, from 0 to 1, of the cumulative area."""
        return np.searchsorted(self._cumulated, shares).clip(0, len(self.points) - 1)


def _steps(thing: _Object, strength: Variation, rng: np.random.Generator) -> list[Deformation]:
    """Return the deformations of a variation, in order.

    The number of random draws does not depend on the strengths, so changing one strength does not affect
    the draws of the others.
    """
    scales, tapered, bends, twisted, limbs, parts, bumps = (
        rng.uniform(-1, 1, count) for count in (3, 1, 2, 1, 2, _PARTS, _BUMPS)
    )
    part_places, bump_places = rng.uniform(0, 1, _PARTS), rng.uniform(0, 1, _BUMPS)
    part_widths, bump_widths = rng.uniform(0, 1, _PARTS), rng.uniform(0, 1, _BUMPS)
    pulls = rng.standard_normal((4, 4, 4, 3)).clip(-2, 2)

    odd = strength.asymmetry
    half = float(np.abs(thing.points[:, 0]).max())
    length, thickness = limbs * [strength.limb_length, strength.limb_thickness]
    up, sideways = np.deg2rad(strength.bend) * bends * [1.0, odd] / (2 * half)
    growing = _parts(thing, strength.parts * parts, part_places, part_widths, odd)
    bulging = _bumps(thing, strength.bumps * bumps, bump_places, bump_widths, odd)
    # Deformations at positions on the surface come first, before it moves.
    return [
        partial(thicken, middle=thing.limbs, growth=float(thickness)),
        partial(together, deformations=growing),
        partial(together, deformations=bulging),
        partial(lengthen, up=thing.up, line=thing.belly, growth=float(length)),
        partial(scale, factors=(1 + strength.scale) ** scales),
        partial(taper, slope=strength.taper * tapered[0] / half),
        partial(_pull, pulls=_mirrored(strength.lattice * pulls, odd)),
        partial(twist, rate=float(np.deg2rad(strength.twist) * odd * twisted[0] / (2 * half))),
        partial(bend, curvature=float(up), across=1),
        partial(bend, curvature=float(sideways), across=2),
    ]


def _parts(
    thing: _Object, growths: Doubles, places: Doubles, widths: Doubles, odd: float
) -> list[Deformation]:
    """Return the growth of parts, each with its mirror image, centred below the surface.

    Positions are fractions of the cumulative area, and widths are fractions of the range of widths.
    """
    centres, _ = thing.trunk.at(thing.points[thing.vertices_at(places)])
    widths = _PART_WIDTH[0] + widths * (_PART_WIDTH[1] - _PART_WIDTH[0])
    found: list[Deformation] = []
    for centre, width, growth in zip(centres, widths, growths, strict=True):
        own, other = _sides(centre, float(width), odd)
        found.append(partial(swell, centre=centre, width=width, growth=own * growth))
        found.append(partial(swell, centre=centre * _MIRROR, width=width, growth=other * growth))
    return found


def _bumps(
    thing: _Object, heights: Doubles, places: Doubles, widths: Doubles, odd: float
) -> list[Deformation]:
    """Return the bumps and hollows along the normal, each with its mirror image."""
    vertices = thing.vertices_at(places)
    widths = _BUMP_WIDTH[0] + widths * (_BUMP_WIDTH[1] - _BUMP_WIDTH[0])
    found: list[Deformation] = []
    for vertex, width, height in zip(vertices, widths, heights, strict=True):
        centre, shift = thing.points[vertex], height * width * thing.normals[vertex]
        own, other = _sides(centre, float(width), odd)
        found.append(partial(bump, centre=centre, width=width, shift=own * shift))
        found.append(partial(bump, centre=centre * _MIRROR, width=width, shift=other * shift * _MIRROR))
    return found


def _sides(centre: Doubles, width: float, odd: float) -> tuple[float, float]:
    """Return the weights of a change and of its mirror image, which are 1/2 each in the plane of symmetry."""
    both = 1 + (1 - odd) * float(np.exp(-((centre[2] / width) ** 2)))
    return 1 / both, (1 - odd) / both


def _mirrored(pulls: Doubles, odd: float) -> Doubles:
    """Return a lattice's displacements, keeping a fraction ``odd`` of their left-right difference."""
    image = pulls[:, :, ::-1] * _MIRROR
    # The mean of two independent pulls is smaller by a factor of √2.
    return np.asarray(((pulls + image) + odd * (pulls - image)) / np.sqrt(2 * (1 + odd**2)))


def _pull(points: Doubles, pulls: Doubles) -> Deformed:
    """Deform points by a lattice around them that is symmetric in width."""
    low, high = points.min(axis=0), points.max(axis=0)
    high[2] = max(-low[2], high[2])
    low[2] = -high[2]
    return free_form(points, low, high, pulls * (high - low))


_VARIATION_VERSION = 1
"""Version in each fingerprint. Increase it if a number gives a different variant than before."""


@dataclass(frozen=True)
class Varied:
    """A random variant of a mesh, determined by its number; a `MeshSource`.

    Args:
        source: source of the original mesh.
        variation: strengths of the variation.
        number: number of the variant, from 0; the random draws depend only on this and on the mesh's name.
    """

    source: MeshSource
    variation: Variation
    number: Count

    def __post_init__(self) -> None:
        check_ranges(self)

    @property
    def name(self) -> str:
        """The source's name and the number: ``horse~1``, or ``horse@3~1`` for a pose."""
        return f"{self.source.name}~{self.number}"

    def fingerprint(self) -> str:
        """Return a hash of the source's fingerprint, the strengths and the number.

        Raises:
            InputError: if the source cannot be read.
        """
        parts = [
            _VARIATION_VERSION,
            self.source.fingerprint(),
            self.name,
            asdict(self.variation),
            self.number,
        ]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def load(self) -> Mesh:
        """Return the variant.

        Raises:
            InputError: if the source cannot be used.
        """
        rng = rng_of(self.source.name, self.number)
        return replace(vary(self.source.load(), self.variation, rng), name=self.name)
