"""The joints of a rig: their hierarchy and their ranges of rotation in animations."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from normalgan.arrays import BoolMask, Doubles, Indices
from normalgan.graphs import connected
from normalgan.rendering.gltf.scene import world_matrices
from normalgan.rendering.rigs.animations import track_at
from normalgan.rendering.rigs.rig import Rig, posed_vertices

DEFAULT_ROTATION = np.deg2rad(12.0)
"""Maximum rotation of a joint about each axis if there is no animation."""
_MOMENTS = 24
"""Number of times at which each animation is evaluated."""
_OUTLIERS = 5.0
"""Percentage of times at either extreme that do not widen a joint's range, because a clip may show a fall."""
_MOST_COPIES = 100
"""Maximum number of coincident vertices of a joint in a neighbour search; k-d trees fail with more."""
_MOST_SEARCHED = 2**23
"""Maximum number of vertices in the search, counted for each loose tree of joints."""


class LooseRigError(ValueError):
    """Error for a rig with too many loose parts to find its hierarchy."""


@dataclass(frozen=True)
class Joints:
    """The joints that move the surface.

    Args:
        nodes: (J,) indices of the joints' nodes, parents first.
        parents: (J,) position in ``nodes`` of each joint's parent, -1 for none.
        low: (J, 3) minimum rotation vectors from the rest pose, in the joint's own axes, in radians; 0 for
            joints without a parent, or with a different parent than in the file.
        high: (J, 3) maximum rotation vectors, likewise.
    """

    nodes: Indices
    parents: Indices
    low: Doubles
    high: Doubles


def find_joints(rig: Rig) -> Joints:
    """Return the joints that move the surface, with their ranges of rotation.

    Rigs for inverse kinematics often attach feet to separate bones, which only animations keep at the
    legs, so rotating a leg alone would leave its foot behind. If the joints that move the surface form
    several trees, each smaller tree is therefore attached to the joint of a larger tree that moves the
    adjacent surface.

    Raises:
        LooseRigError: if there are too many such trees.
    """
    points, owners = owned_vertices(rig)
    nodes = rig.nodes
    moving = np.zeros(len(nodes.parents), dtype=bool)
    moving[owners] = True
    parents = np.full(len(nodes.parents), -1)
    for index in nodes.order:
        above = nodes.parents[index]
        if above >= 0:
            parents[index] = above if moving[above] else parents[above]
    hung = _hang_together(points, owners, parents, moving)
    members = _ordered(hung, moving)
    position = {int(node): place for place, node in enumerate(members)}
    low, high = _ranges(rig, members)
    fixed = (hung[members] < 0) | (hung[members] != parents[members])
    low[fixed], high[fixed] = 0.0, 0.0
    return Joints(members, np.array([position.get(int(hung[node]), -1) for node in members]), low, high)


def owned_vertices(rig: Rig) -> tuple[Doubles, Indices]:
    """Return all vertices (V, 3) in the rest pose, and the node (V,) with the largest weight for each."""
    world = world_matrices(rig.nodes)
    points, owners = [], []
    for piece in rig.pieces:
        points.append(posed_vertices(piece, world))
        if piece.skin is None:
            owners.append(np.full(len(piece.vertices), piece.node))
        else:
            strongest = np.take_along_axis(piece.joints, piece.weights.argmax(axis=1)[:, None], axis=1)
            owners.append(piece.skin.joints[strongest[:, 0]])
    return np.concatenate(points), np.concatenate(owners)


def _hang_together(points: Doubles, owners: Indices, parents: Indices, moving: BoolMask) -> Indices:
    """Return the parents, with smaller trees attached to the joints of larger trees that they touch."""
    parents = np.where(moving, parents, -1)
    points, owners = _thinned(points, owners)
    loose = int((parents[np.unique(owners)] < 0).sum())
    if loose > 1 and loose * len(points) > _MOST_SEARCHED:
        raise LooseRigError(f"its {len(points)} vertices hang on {loose} loose trees of nodes; join them")
    while True:
        child = np.flatnonzero(parents >= 0)
        tree = connected(len(parents), np.column_stack([child, parents[child]]))[owners]
        names, sizes = np.unique(tree, return_counts=True)
        if len(names) == 1:
            return parents
        loose = names[sizes.argmin()]
        mine, others = tree == loose, tree != loose
        found = cKDTree(points[others]).query(points[mine])
        distance, nearest = np.asarray(found[0]), np.asarray(found[1], dtype=np.int64)
        # Surfaces meet at a joint, so the nearest tenth of the vertices decides.
        close = distance <= np.quantile(distance, 0.1)
        keepers, votes = np.unique(owners[others][nearest[close]], return_counts=True)
        roots = [node for node in np.unique(owners[mine]) if parents[node] < 0]
        parents[roots] = keepers[votes.argmax()]


def _thinned(points: Doubles, owners: Indices) -> tuple[Doubles, Indices]:
    """Return points and owners in the same order, with at most `_MOST_COPIES` copies of a point."""
    placed = np.column_stack([points, owners])
    order = np.lexsort(placed.T)
    first = np.r_[True, (placed[order[1:]] != placed[order[:-1]]).any(axis=1)]
    starts = np.flatnonzero(first)
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(np.r_[starts, len(order)]))
    kept = np.sort(order[rank < _MOST_COPIES])
    return points[kept], owners[kept]


def _ordered(parents: Indices, moving: BoolMask) -> Indices:
    """Return the moving nodes, parents first."""

    def depth(node: int) -> int:
        count = 0
        while (node := int(parents[node])) >= 0:
            count += 1
        return count

    members = np.flatnonzero(moving)
    return members[np.argsort([depth(int(node)) for node in members], kind="stable")]


def _ranges(rig: Rig, members: Indices) -> tuple[Doubles, Doubles]:
    """Return the minimum and maximum rotations (J, 3) of each joint from the rest pose in the animations."""
    if not rig.clips:
        reach = np.full((len(members), 3), DEFAULT_ROTATION)
        return -reach, reach
    turns = np.zeros((len(rig.clips), _MOMENTS, len(rig.nodes.parents), 3))
    for clip, seen in zip(rig.clips, turns, strict=True):
        moments = np.linspace(*clip.span, _MOMENTS)
        for track in clip.tracks:
            if track.path == "rotation":
                rest = Rotation.from_quat(rig.nodes.rotations[track.node]).inv()
                seen[:, track.node] = (rest * Rotation.from_quat(track_at(track, moments))).as_rotvec()
    limits = np.percentile(turns[:, :, members], [_OUTLIERS, 100 - _OUTLIERS], axis=(0, 1))
    return np.minimum(limits[0], 0.0), np.maximum(limits[1], 0.0)
