"""The topology of a mesh, by sparse graphs: its bodies, their winding, its hard edges."""

import numpy as np

from normalgan.arrays import BoolMask, Indices
from normalgan.graphs import connected

__all__ = ["bodies", "neighbours", "seams"]


def neighbours(faces: Indices) -> tuple[Indices, Indices, BoolMask]:
    """Return the pairs of faces that share an edge with each other and with no third face.

    Args:
        faces: (F, 3) vertex indices.

    Returns:
        first: (E,) indices of faces.
        second: (E,) indices of their neighbours.
        alike: (E,) whether their windings agree: they run along their edge in opposite directions.
    """
    first, second, start, end = _shared_edges(faces)
    return first // 3, second // 3, start == end


def _shared_edges(faces: Indices) -> tuple[Indices, Indices, Indices, Indices]:
    """Return (E,) half-edges ``3 * face + side``, their partners, the start of one, the end of the other."""
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = np.minimum(starts, ends) * (int(faces.max()) + 1) + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    _, begin, count = np.unique(keys[order], return_index=True, return_counts=True)
    pairs = begin[count == 2]
    first, second = order[pairs], order[pairs + 1]
    return first, second, starts[first], ends[second]


def bodies(faces: Indices) -> tuple[Indices, BoolMask]:
    """Return each face's body (F,), and which faces (F,) to flip for a consistent winding.

    A graph holds every face twice, unchanged and flipped. Neighbours with the same winding are linked copy to
    copy, others crosswise. An orientable body then splits into two mirrored components, and either is a
    consistent winding. Another (a Möbius strip) stays one component, and is not changed.
    """
    first, second, alike = neighbours(faces)
    count = len(faces)
    body = connected(count, np.column_stack([first, second]))
    other = np.where(alike, 0, count)
    copies = np.r_[first, first + count], np.r_[second + other, second + count - other]
    label = connected(2 * count, np.column_stack(copies)).reshape(2, count)
    # The first face of a body stays; faces whose flipped copy is connected to it are flipped.
    _, leaders = np.unique(body, return_index=True)
    chosen = label[0, leaders][body]
    return body, (label[0] != chosen) & (label[1] == chosen)


def seams(faces: Indices, soft: BoolMask) -> tuple[Indices, Indices]:
    """Split vertices whose faces no soft edge connects.

    Args:
        faces: (F, 3) vertex indices.
        soft: (E,) for each pair of `neighbours`, whether normals run smoothly across their edge.

    Returns:
        origin: (V',) the old vertex of each new one.
        faces: (F, 3) indices of new vertices.
    """
    first, second, start, end = _shared_edges(faces)
    # The corners at the start and end of the first half-edge; its partner may run either way.
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
