"""Repair triangles: weld, remove degenerate ones, wind consistently outward; then compute normals."""

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.topology import bodies, neighbours, seams

__all__ = ["GRID", "face_vectors", "shade", "weld", "wind"]

GRID = 2**20
"""Vertices in one cell of a grid of this many cells a side are one vertex: a millionth of the size."""


def weld(vertices: Doubles, faces: Indices) -> tuple[Doubles, Indices]:
    """Merge vertices in the same place, drop faces without area and second copies, and unused vertices.

    Seams that a file keeps for textures or hard edges would break up smooth normals; two copies of a face
    with opposite windings would cancel them.

    Args:
        vertices: (V, 3) positions in any unit.
        faces: (F, 3) vertex indices.
    """
    used = vertices[np.unique(faces)]
    low, size = used.min(axis=0), float(np.ptp(used, axis=0).max())
    if size == 0:
        return vertices[:0], faces[:0]
    # 21 bits for each axis: one integer for each cell sorts faster than three.
    cells = np.rint(np.clip((vertices - low) / size, 0, 1) * GRID).astype(np.int64) @ [1 << 42, 1 << 21, 1]
    _, first, cell = np.unique(cells, return_index=True, return_inverse=True)
    vertices, faces = vertices[first], cell[faces]

    cross = face_vectors(vertices, faces)
    a, b, c = faces.T
    sound = (a != b) & (b != c) & (c != a) & (np.linalg.norm(cross, axis=1) > (size / GRID) ** 2)
    faces = faces[sound]
    _, copies = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(copies)]
    kept, renumbered = np.unique(faces, return_inverse=True)
    return vertices[kept], renumbered.reshape(-1, 3)


def face_vectors(vertices: Doubles, faces: Indices) -> Doubles:
    """Return the face normals (F, 3); their length is twice the area."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def wind(vertices: Doubles, faces: Indices, inside_out: bool | None) -> Indices:
    """Return the faces with consistent winding within each body, counter-clockwise seen from outside.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, welded.
        inside_out: whether most of the file is wound clockwise; None to find out for each body, from the
            sign of its volume about its own centroid, which for an open body stands for the volume that
            it would have with its holes closed towards the centroid.
    """
    body, turn = bodies(faces)
    area = np.linalg.norm(face_vectors(vertices, faces), axis=1)
    # The side with more area keeps the winding it has in the file.
    turned_area, whole = (np.bincount(body, area * part) for part in (turn, 1.0))
    turn = turn ^ (turned_area > whole / 2)[body]
    faces = np.where(turn[:, None], faces[:, ::-1], faces)
    if inside_out is not None:
        return faces[:, ::-1] if inside_out else faces
    inward = _volumes(vertices, faces, body, area) < 0
    return np.where(inward[body][:, None], faces[:, ::-1], faces)


def _volumes(vertices: Doubles, faces: Indices, body: Indices, area: Doubles) -> Doubles:
    """Return the signed volume of each body between its faces and its centroid."""
    middle = vertices[faces].mean(axis=1)
    sums = np.stack([np.bincount(body, area * middle[:, i]) for i in range(3)], axis=-1)
    centroid = sums / np.bincount(body, area)[:, None]
    height = np.einsum("fc,fc->f", middle - centroid[body], face_vectors(vertices, faces))
    return np.bincount(body, height) / 6


def shade(vertices: Doubles, faces: Indices, crease_angle: float | None) -> tuple[Doubles, Indices, Doubles]:
    """Return vertices, faces and unit vertex normals, vertices doubled along hard edges.

    A normal is the mean of the adjoining faces' normals, weighted by their angles at the vertex (Thürmer
    and Wüthrich, Journal of Graphics Tools 3(1), 1998): it does not depend on how faces are cut up.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, welded, with consistent winding.
        crease_angle: edges with a larger angle between their faces' normals, in degrees, stay hard; None
            smooths all.
    """
    flat = face_vectors(vertices, faces)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    if crease_angle is not None:
        first, second, _ = neighbours(faces)
        soft = np.einsum("ec,ec->e", flat[first], flat[second]) >= np.cos(np.deg2rad(crease_angle))
        origin, faces = seams(faces, soft)
        vertices = vertices[origin]
    angles = _corner_angles(vertices, faces)
    corners = faces.ravel()
    pulls = (angles[:, :, None] * flat[:, None, :]).reshape(-1, 3)
    normals = np.stack([np.bincount(corners, pulls[:, i], len(vertices)) for i in range(3)], axis=-1)
    length = np.linalg.norm(normals, axis=1)
    # Where they cancel (two sheets back to back), the normal of any face will do.
    lost = length < 1e-6
    stand_in = np.zeros_like(normals)
    stand_in[corners] = np.repeat(flat, 3, axis=0)
    normals[lost], length[lost] = stand_in[lost], 1.0
    return vertices, faces, normals / length[:, None]


def _corner_angles(vertices: Doubles, faces: Indices) -> Doubles:
    """Return the (F, 3) angles of the triangles at their corners, in radians."""
    points = vertices[faces]
    to_next, to_last = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    across = np.linalg.norm(np.cross(to_next, to_last), axis=-1)
    return np.asarray(np.arctan2(across, np.einsum("fkc,fkc->fk", to_next, to_last)))
