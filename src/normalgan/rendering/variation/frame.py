"""The axes of an object: where it is long, where up is, and the plane that parts left from right."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.repair import face_vectors

__all__ = ["Frame", "find_frame"]

_COARSE, _FINE = np.arange(0.0, 180.0, 5.0), np.arange(-4.5, 5.0, 0.5)
"""Degrees by which the plane of symmetry is turned to try it: first all around, then about the best."""
_ACROSS = 0.002
"""Penalty of a mirrored vertex for its distance across the plane."""
_PROBES = 500
"""How many vertices are mirrored to try one."""


@dataclass(frozen=True)
class Frame:
    """An object's own coordinates; the third is 0 in the plane that parts left from right.

    Args:
        centre: (3,) middle of the surface.
        axes: (3, 3) rows: the longer one of forward and up; the other one; sideways.
        up: which of them points up, 0 or 1.
        areas: (V,) area of the surface around each vertex.
    """

    centre: Doubles
    axes: Doubles
    up: int
    areas: Doubles

    def inward(self, positions: Doubles) -> Doubles:
        """Return positions (V, 3) of the mesh in these coordinates."""
        return np.asarray((positions - self.centre) @ self.axes.T)

    def outward(self, points: Doubles) -> Doubles:
        """Return points (V, 3) in these coordinates as positions of the mesh."""
        return np.asarray(points @ self.axes + self.centre)


def find_frame(mesh: Mesh) -> Frame:
    """Return the frame of a mesh, whose up is +Y.

    The plane of symmetry is the upright one through the middle in which the object's mirror image comes
    nearest to itself.
    """
    from scipy.spatial import cKDTree  # half a second: only when a mesh is varied

    vertices = mesh.vertices.astype(np.float64)
    face_area = np.linalg.norm(face_vectors(vertices, mesh.faces.astype(np.int64)), axis=1) / 2
    areas: Doubles = np.zeros(len(vertices))
    np.add.at(areas, mesh.faces, face_area[:, None] / 3)
    centre = areas @ vertices / areas.sum()
    offsets = vertices - centre
    probes = offsets[:: max(1, len(offsets) // _PROBES)]
    tree = cKDTree(offsets)

    def miss(turn: float) -> float:
        side = _sideways(turn)
        missed = np.mean(tree.query(probes - 2 * np.outer(probes @ side, side))[0])
        # Of several planes, the one along the object.
        return float(missed + _ACROSS * np.ptp(probes @ side))

    best = min(_COARSE, key=miss)
    side = _sideways(min(best + _FINE, key=miss))
    up = np.array([0.0, 1.0, 0.0])
    forward = np.cross(up, side)
    tall = np.ptp(offsets @ up) > np.ptp(offsets @ forward)
    axes = np.stack([up, forward, side] if tall else [forward, up, side])
    return Frame(centre, axes, 0 if tall else 1, areas)


def _sideways(turn: float) -> Doubles:
    """Return the level direction ``turn`` degrees from +X towards +Z."""
    return np.array([np.cos(np.deg2rad(turn)), 0.0, np.sin(np.deg2rad(turn))])
