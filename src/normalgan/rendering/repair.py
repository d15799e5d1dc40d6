"""Repair of triangles: welding, removing degenerate ones, consistent winding, and vertex normals."""

import numpy as np

from normalgan.arrays import BoolMask, Doubles, Indices
from normalgan.graphs import connected

_GRID = 2**20
"""Number of grid cells per side for welding vertices, so the tolerance is a millionth of the size."""


def weld(vertices: Doubles, faces: Indices) -> tuple[Doubles, Indices]:
    """Merge coincident vertices, and drop faces without area, duplicate faces and unused vertices.

    Seams in a file for textures or hard edges would interrupt smooth normals, and two copies of a face
    with opposite windings would cancel them.

    Args:
        vertices: (V, 3) positions in any unit.
        faces: (F, 3) vertex indices.
    """
    used = vertices[np.unique(faces)]
    low, size = used.min(axis=0), float(np.ptp(used, axis=0).max())
    if size == 0:
        return vertices[:0], faces[:0]
    # 21 bits per axis, because one integer per cell sorts faster than three.
    cells = np.rint(np.clip((vertices - low) / size, 0, 1) * _GRID).astype(np.int64) @ [1 << 42, 1 << 21, 1]
    _, first, cell = np.unique(cells, return_index=True, return_inverse=True)
    vertices, faces = vertices[first], cell[faces]

    cross = face_vectors(vertices, faces)
    a, b, c = faces.T
    sound = (a != b) & (b != c) & (c != a) & (np.linalg.norm(cross, axis=1) > (size / _GRID) ** 2)
    faces = faces[sound]
    _, copies = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(copies)]
    kept, renumbered = np.unique(faces, return_inverse=True)
    return vertices[kept], renumbered.reshape(-1, 3)


def face_vectors(vertices: Doubles, faces: Indices) -> Doubles:
    """Return the face normals (F, 3) with a length of twice the area."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def wind(vertices: Doubles, faces: Indices, inside_out: bool | None) -> Indices:
    """Return the faces with consistent winding in each body, counter-clockwise when viewed from outside.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, welded.
        inside_out: whether most faces in the file are wound clockwise. None detects it for each body from
            the sign of its volume relative to its own centroid, as if holes were closed towards the
            centroid.
    """
    body, turn = bodies(faces)
    area = np.linalg.norm(face_vectors(vertices, faces), axis=1)
    # The side with more area keeps its winding in the file.
    turned_area, whole = (np.bincount(body, area * part) for part in (turn, 1.0))
    turn = turn ^ (turned_area > whole / 2)[body]
    faces = np.where(turn[:, None], faces[:, ::-1], faces)
    if inside_out is not None:
        return faces[:, ::-1] if inside_out else faces
    inward = _volumes(vertices, faces, body, area) < 0
    return np.where(inward[body][:, None], faces[:, ::-1], faces)


def _volumes(vertices: Doubles, faces: Indices, body: Indices, area: Doubles) -> Doubles:
    """Return the signed volume between the faces and the centroid of each body."""
    middle = vertices[faces].mean(axis=1)
    sums = np.stack([np.bincount(body, area * middle[:, i]) for i in range(3)], axis=-1)
    centroid = sums / np.bincount(body, area)[:, None]
    height = np.einsum("fc,fc->f", middle - centroid[body], face_vectors(vertices, faces))
    return np.bincount(body, height) / 6


def shade(vertices: Doubles, faces: Indices, crease_angle: float | None) -> tuple[Doubles, Indices, Doubles]:
    """Return vertices, faces and unit vertex normals, with duplicate vertices along sharp edges.

    A normal is the mean of the adjacent faces' normals, weighted by their angles at the vertex (Thürmer
    and Wüthrich, Journal of Graphics Tools 3(1), 1998), so it does not depend on the triangulation.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices, welded, with consistent winding.
        crease_angle: angle between the faces' normals, in degrees, above which an edge stays sharp; None
            smooths all edges.
    """
    flat = face_vectors(vertices, faces)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    if crease_angle is not None:
        first, second, _ = _neighbours(faces)
        soft = np.einsum("ec,ec->e", flat[first], flat[second]) >= np.cos(np.deg2rad(crease_angle))
        origin, faces = _seams(faces, soft)
        vertices = vertices[origin]
    angles = _corner_angles(vertices, faces)
    corners = faces.ravel()
    pulls = (angles[:, :, None] * flat[:, None, :]).reshape(-1, 3)
    normals = np.stack([np.bincount(corners, pulls[:, i], len(vertices)) for i in range(3)], axis=-1)
    length = np.linalg.norm(normals, axis=1)
    # Where normals cancel (two sheets back to back), the normal of any face will do.
    lost = length < 1e-6
    stand_in = np.zeros_like(normals)
    stand_in[corners] = np.repeat(flat, 3, axis=0)
    normals[lost], length[lost] = stand_in[lost], 1.0
    return vertices, faces, normals / length[:, None]


def _corner_angles(vertices: Doubles, faces: Indices) -> Doubles:
    """Return the corner angles (F, 3) of the triangles in radians."""
    points = vertices[faces]
    to_next, to_last = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    across = np.linalg.norm(np.cross(to_next, to_last), axis=-1)
    return np.asarray(np.arctan2(across, np.einsum("fkc,fkc->fk", to_next, to_last)))


def _neighbours(faces: Indices) -> tuple[Indices, Indices, BoolMask]:
    """Return the pairs of faces with a common edge that belongs to no third face.

    Args:
        faces: (F, 3) vertex indices.

    Returns:
        first: (E,) indices of faces.
        second: (E,) indices of their neighbours.
        alike: (E,) whether their windings agree, so that they traverse the edge in opposite directions.
    """
    first, second, start, end = _shared_edges(faces)
    return first // 3, second // 3, start == end


def _shared_edges(faces: Indices) -> tuple[Indices, Indices, Indices, Indices]:
    """Return (E,) half-edges ``3 * face + side``, their partners, their starts, and their partners' ends."""
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = np.minimum(starts, ends) * (int(faces.max()) + 1) + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    _, begin, count = np.unique(keys[order], return_index=True, return_counts=True)
    pairs = begin[count == 2]
    first, second = order[pairs], order[pairs + 1]
    return first, second, starts[first], ends[second]


def bodies(faces: Indices) -> tuple[Indices, BoolMask]:
    """Return each face's body (F,), and which faces (F,) to flip for a consistent winding.

    In a graph with two nodes per face, one unchanged and one flipped, neighbours with the same winding are
    linked unchanged to unchanged and flipped to flipped, and others crosswise. An orientable body then
    forms two mirrored components, each of which is a consistent winding. A non-orientable body (a Möbius
    strip) forms one component and is not changed.
    """
    first, second, alike = _neighbours(faces)
    count = len(faces)
    body = connected(count, np.column_stack([first, second]))
    other = np.where(alike, 0, count)
    copies = np.r_[first, first + count], np.r_[second + other, second + count - other]
    label = connected(2 * count, np.column_stack(copies)).reshape(2, count)
    # The first face of a body is kept, and faces with a flipped node connected to it are flipped.
    _, leaders = np.unique(body, return_index=True)
    chosen = label[0, leaders][body]
    return body, (label[0] != chosen) & (label[1] == chosen)


def _seams(faces: Indices, soft: BoolMask) -> tuple[Indices, Indices]:
    """Split vertices between faces that are not connected by soft edges.

    Args:
        faces: (F, 3) vertex indices.
        soft: (E,) for each pair of `_neighbours`, whether normals are smooth across the edge.

    Returns:
        origin: (V',) index of the old vertex for each new vertex.
        faces: (F, 3) indices of the new vertices.
    """
    first, second, start, end = _shared_edges(faces)
    # The corners at the start and end of the first half-edge; its partner may have either direction.
    after_first, after_second = _next_corner(first), _next_corner(second)
    opposite = start == end
    at_start = np.where(opposite, after_second, second)
    at_end = np.where(opposite, second, after_second)
    meeting = np.r_[first[soft], after_first[soft]], np.r_[at_start[soft], at_end[soft]]
    corner = connected(faces.size, np.column_stack(meeting))
    _, member = np.unique(corner, return_index=True)
    return faces.ravel()[member], corner.reshape(-1, 3)


def _next_corner(half_edges: Indices) -> Indices:
    return half_edges - half_edges % 3 + (half_edges + 1) % 3
