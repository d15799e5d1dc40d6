"""Rig: nodes in a tree, pieces of surface bound to them, clips that move them."""

from dataclasses import dataclass

from normalgan.arrays import Doubles, Indices
from normalgan.rendering.gltf.nodes import Nodes

__all__ = ["Clip", "Piece", "Rig", "Skin", "Track"]


@dataclass(frozen=True)
class Skin:
    """The nodes that move a surface.

    Args:
        joints: (J,) indices of nodes.
        inverse_bind: (J, 4, 4) from the surface's axes to those of the joint at rest, for column vectors.
    """

    joints: Indices
    inverse_bind: Doubles


@dataclass(frozen=True)
class Piece:
    """A surface that moves rigidly with a node, or bends with the joints of a skin.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) vertex indices.
        node: index of the node that it is attached to.
        skin: moves it instead of its node; None if it is rigid.
        joints: (V, K) indices into the skin's joints.
        weights: (V, K) the share of each, summing to 1.
    """

    vertices: Doubles
    faces: Indices
    node: int
    skin: Skin | None
    joints: Indices
    weights: Doubles


@dataclass(frozen=True)
class Track:
    """The animation of one property of one node.

    Args:
        node: index of the node.
        path: translation, rotation or scale.
        interpolation: LINEAR, STEP or CUBICSPLINE.
        times: (T,) seconds, ascending.
        values: (T, 3, D) for each time the tangent towards it, the value and the tangent away from it;
            the tangents are 0 unless the interpolation is CUBICSPLINE.
    """

    node: int
    path: str
    interpolation: str
    times: Doubles
    values: Doubles


@dataclass(frozen=True)
class Clip:
    """An animation: tracks that run together.

    Args:
        name: as in the file, empty if it has none.
        tracks: at most one for each node and property.
    """

    name: str
    tracks: tuple[Track, ...]

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time of all tracks, in seconds."""
        return (
            min(float(track.times[0]) for track in self.tracks),
            max(float(track.times[-1]) for track in self.tracks),
        )


@dataclass(frozen=True)
class Rig:
    """A surface that can be posed.

    Args:
        nodes: what moves.
        pieces: what is seen.
        clips: how it can move; those without a track are left out.
        names: names of the nodes in the file; empty if it has none.
    """

    nodes: Nodes
    pieces: tuple[Piece, ...]
    clips: tuple[Clip, ...]
    names: tuple[str, ...]
