"""Joints without a skeleton: limbs are found on the surface and bent where they are thin."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Doubles
from normalgan.graphs import connected
from normalgan.rendering.variation.deformations import Deformed

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_MOST_TIPS = 8
"""Maximum number of limb ends; a person has five, a dog with a tail six."""
_SHORTEST_LIMB = 0.35
"""Minimum length of a limb, as a fraction of the longest limb."""
_MOST_JOINTS = 2
"""Maximum number of joints of a limb, such as knee and hip or elbow and shoulder."""
_PLACES = np.linspace(0.25, 0.8, 12)
"""Range of possible positions of a joint, from the limb's tip (0) to the middle of the object (1)."""
_THICKEST_LIMB = 0.35
"""Maximum ratio of a limb's radius at a joint to its length beyond it; thicker parts are not limbs."""
_BAND = 1.5
"""Half of a joint's length, in radii of the limb; a shorter joint would crease at 70 degrees."""
_TORN = 0.1
"""Maximum remaining fraction of a rotation at the ends of a joint."""
_FEWEST_VERTICES = 3
"""Minimum number of vertices on either side of a joint, for estimating the limb's direction."""
_CLOTH_DISTANCE = 0.02
"""Distance within which separate parts such as body and clothes move together, in radii of the object."""


@dataclass(frozen=True)
class Joint:
    """A joint where a limb bends.

    Args:
        centre: (3,) centre of the limb at the joint.
        outward: (3,) unit direction of the limb towards its tip.
        band: half of the length over which the rotation increases.
        beyond: (V,) mask of vertices between the joint and the tip, including those of the joint.
        near: (V,) mask of vertices of the joint itself.
    """

    centre: Doubles
    outward: Doubles
    band: float
    beyond: BoolMask
    near: BoolMask

    def fraction(self, points: Doubles) -> tuple[Doubles, Doubles]:
        """Return the fractions (V,) of the rotation at points (V, 3), and their outward derivatives."""
        along = np.clip(((points - self.centre) @ self.outward) / (2 * self.band) + 0.5, 0.0, 1.0)
        fraction = np.where(self.near, along**2 * (3 - 2 * along), self.beyond)
        return fraction, np.where(self.near, 6 * along * (1 - along) / (2 * self.band), 0.0)

    def bend(self, points: Doubles, axis: Doubles, angle: float) -> Deformed:
        """Rotate the vertices beyond the joint.

        Args:
            points: (V, 3) points.
            axis: (3,) unit axis of the rotation, through the joint's centre.
            angle: angle in radians.
        """
        from scipy.spatial.transform import Rotation  # takes half a second to import

        fraction, slope = self.fraction(points)
        rotation = Rotation.from_rotvec(np.outer(angle * fraction, axis)).as_matrix()
        moved = (rotation @ (points - self.centre)[:, :, None])[:, :, 0]
        # The outward increase of the rotation.
        speed = angle * slope[:, None] * np.cross(axis, moved)
        return moved + self.centre, rotation + speed[:, :, None] * self.outward


def find_limb_joints(points: Doubles, faces: NDArray[np.integer], rng: np.random.Generator) -> list[Joint]:
    """Find the limbs of a surface, and return up to two joints per limb, where it is thin.

    The tips of limbs are points with maximum geodesic distance from each other. The middle of the object
    is the point with the smallest maximum distance from them.

    Args:
        points: (V, 3) vertices of an object of about unit radius.
        faces: (F, 3) vertex indices.
        rng: source of randomness for the positions of joints along their limbs.

    Returns:
        The joints, outer joints before inner ones.
    """
    places, place_of = np.unique(points.round(6), axis=0, return_inverse=True)
    place_of = place_of.ravel()
    joints: list[Joint] = []
    for distance, length in _limbs(*_graph(places, place_of[faces])):
        found = [_joint(places, distance, place * length) for place in _PLACES]
        thin = [joint for joint in found if joint is not None]
        chosen: list[Joint] = []
        for index in rng.permutation(len(thin)):
            joint = thin[index]
            if len(chosen) < _MOST_JOINTS and not any((joint.near & other.near).any() for other in chosen):
                chosen.append(joint)
        joints += [replace(one, beyond=one.beyond[place_of], near=one.near[place_of]) for one in chosen]
    return sorted(joints, key=lambda joint: int(joint.beyond.sum()))


def _limbs(graph: "csr_array", whole: BoolMask) -> Iterator[tuple[Doubles, float]]:
    """Yield, for each limb, the distances (P,) of all places from its tip, and its length."""
    from scipy.sparse.csgraph import dijkstra  # takes half a second to import

    def distances(start: int) -> Doubles:
        return np.asarray(cast("Any", dijkstra)(graph, indices=start))  # some type stubs lack csr_array

    nearest = distances(int(np.argmax(whole)))
    reached: list[Doubles] = []
    for _ in range(_MOST_TIPS):
        tip = int(np.argmax(np.where(whole, nearest, -1.0)))
        reached.append(distances(tip))
        nearest = np.minimum.reduce(reached)
    middle = int(np.argmin(np.where(whole, np.maximum.reduce(reached), np.inf)))
    longest = max(distance[middle] for distance in reached)
    for distance in reached:
        if distance[middle] >= _SHORTEST_LIMB * longest:
            yield distance, distance[middle]


def _joint(places: Doubles, distance: Doubles, length: float) -> Joint | None:
    """Return the joint of a limb at a distance from its tip, or None if the limb is too thick there."""
    ring = np.abs(distance - length) < length / 8
    outer = ring & (distance < length)
    if min(outer.sum(), (ring & ~outer).sum()) < _FEWEST_VERTICES:
        return None
    centre = places[ring].mean(axis=0)
    outward = places[outer].mean(axis=0) - places[ring & ~outer].mean(axis=0)
    outward /= max(float(np.linalg.norm(outward)), 1e-9)
    offset = places[ring] - centre
    across = offset - np.outer(offset @ outward, outward)
    radius = float(np.quantile(np.linalg.norm(across, axis=1), 0.9))
    band = _BAND * radius
    if radius > _THICKEST_LIMB * length or band > length / 1.5:
        return None
    near = np.abs(distance - length) < 1.5 * band
    joint = Joint(centre, outward, band, distance < length + 1.5 * band, near)
    # If another limb is in between, the surface continues beyond the joint and would tear.
    fraction, _ = joint.fraction(places)
    torn = (fraction[near & (distance > length + band)] > _TORN).any() or (
        fraction[near & (distance < length - band)] < 1 - _TORN
    ).any()
    return None if torn else joint


def _graph(places: Doubles, faces: NDArray[np.integer]) -> tuple["csr_array", BoolMask]:
    """Return the edge lengths as a graph with links between parts, and a mask of the largest component."""
    from scipy.sparse import coo_array
    from scipy.spatial import cKDTree

    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    part = connected(len(places), edges)
    pairs = cKDTree(places).query_pairs(_CLOTH_DISTANCE, output_type="ndarray")
    links = pairs[part[pairs[:, 0]] != part[pairs[:, 1]]]
    edges = np.unique(np.sort(np.concatenate([edges, links]), axis=1), axis=0)
    lengths = np.linalg.norm(places[edges[:, 0]] - places[edges[:, 1]], axis=1)
    both = np.concatenate([edges, edges[:, ::-1]])
    graph = coo_array((np.tile(lengths, 2) + 1e-9, both.T), shape=(len(places), len(places))).tocsr()
    part = connected(len(places), edges)
    return graph, part == np.bincount(part).argmax()
