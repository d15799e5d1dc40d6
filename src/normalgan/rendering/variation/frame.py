"""The axes of an object: its length, up, and the normal of its plane of symmetry."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.repair import face_vectors

_COARSE, _FINE = np.arange(0.0, 180.0, 5.0), np.arange(-4.5, 5.0, 0.5)
"""Steps in degrees of the search for the plane of symmetry, first over all angles, then around the best."""
_ACROSS_WEIGHT = 0.002
"""Weight of the distance across the plane in the penalty of a mirrored vertex."""
_PROBES = 500
"""Number of vertices that are mirrored to test a plane."""


@dataclass(frozen=True)
class ObjectFrame:
    """An object's own coordinate system; the third coordinate is 0 in the plane of symmetry.

    Args:
        centre: (3,) centre of the surface.
        axes: (3, 3) axes as rows: the longer one of forward and up, the other one, and sideways.
        up: index of the axis that points up, 0 or 1.
        areas: (V,) area of the surface around each vertex.
    """

    centre: Doubles
    axes: Doubles
    up: int
    areas: Doubles

    def inward(self, positions: Doubles) -> Doubles:
        """Convert positions (V, 3) of the mesh to these coordinates."""
        return np.asarray((positions - self.centre) @ self.axes.T)

    def outward(self, points: Doubles) -> Doubles:
        """Convert points (V, 3) in these coordinates to positions of the mesh."""
        return np.asarray(points @ self.axes + self.centre)


def find_frame(mesh: Mesh) -> ObjectFrame:
    """Return the frame of a mesh with +Y up.

    The plane of symmetry is the vertical plane through the centre for which the mirror image is closest to
    the object.
    """
    from scipy.spatial import cKDTree  # takes half a second to import, only needed to vary meshes

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
        # Prefer the plane along the object if there are several.
        return float(missed + _ACROSS_WEIGHT * np.ptp(probes @ side))

    best = min(_COARSE, key=miss)
    side = _sideways(min(best + _FINE, key=miss))
    up = np.array([0.0, 1.0, 0.0])
    forward = np.cross(up, side)
    tall = np.ptp(offsets @ up) > np.ptp(offsets @ forward)
    axes = np.stack([up, forward, side] if tall else [forward, up, side])
    return ObjectFrame(centre, axes, 0 if tall else 1, areas)


def _sideways(turn: float) -> Doubles:
    """Return the horizontal direction ``turn`` degrees from +X towards +Z."""
    return np.array([np.cos(np.deg2rad(turn)), 0.0, np.sin(np.deg2rad(turn))])
