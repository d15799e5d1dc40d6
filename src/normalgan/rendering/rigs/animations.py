"""Animations of glTF: reading, checks, and evaluation at given times."""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from normalgan.arrays import Doubles
from normalgan.rendering.gltf.accessors import read_accessor
from normalgan.rendering.gltf.container import Container, bad_gltf
from normalgan.rendering.gltf.scene import Nodes
from normalgan.rendering.rigs.rig import Clip, Track

_KINDS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
_MOST_CHANNELS = 2**14
"""Maximum number of channels; each takes 0.1 ms to read, and rigs have a few thousand."""
_MOST_MOVED = 2**18
"""Maximum number of nodes, counted for each animation."""
_INTERPOLATIONS = ("LINEAR", "STEP", "CUBICSPLINE")


def read_clips(container: Container, nodes: Nodes) -> tuple[Clip, ...]:
    """Return the animations of a file that move nodes.

    Raises:
        InputError: if an animation is inconsistent.
    """
    animations = container.tree.get("animations", [])
    channels = sum(len(animation["channels"]) for animation in animations)
    if channels > _MOST_CHANNELS or len(animations) * len(nodes.parents) > _MOST_MOVED:
        raise bad_gltf(
            container.path, f"it has {len(animations)} animations of {channels} channels; delete most of them"
        )
    clips = []
    for animation in animations:
        tracks = [
            _track(container, nodes, animation, channel)
            for channel in animation["channels"]
            if "node" in channel["target"] and channel["target"]["path"] in _KINDS  # not morph weights
        ]
        if tracks:
            clips.append(Clip(str(animation.get("name", "")), tuple(tracks)))
    return tuple(clips)


def _track(container: Container, nodes: Nodes, animation: dict[str, Any], channel: dict[str, Any]) -> Track:
    node, path = channel["target"]["node"], channel["target"]["path"]
    container.item("nodes", node)
    if node in nodes.matrices:
        raise bad_gltf(container.path, f"an animation moves node {node}, which is placed by a matrix")
    sampler = animation["samplers"][channel["sampler"]]
    interpolation = sampler.get("interpolation", "LINEAR")
    if interpolation not in _INTERPOLATIONS:
        raise bad_gltf(container.path, f"an animation is interpolated by {interpolation!r}")
    times = read_accessor(container, sampler["input"], "SCALAR")[:, 0].astype(np.float64)
    values = read_accessor(container, sampler["output"], _KINDS[path]).astype(np.float64)
    triples = np.zeros((len(times), 3, values.shape[1]))
    if interpolation == "CUBICSPLINE":
        sound = len(values) == 3 * len(times)
        triples = values.reshape(len(times), 3, -1) if sound else triples
    else:
        sound = len(values) == len(times)
        triples[:, 1] = values if sound else 0.0
    if not sound:
        raise bad_gltf(container.path, f"an animation has {len(values)} values for {len(times)} times")
    if not (np.isfinite(times).all() and np.isfinite(values).all() and (np.diff(times) > 0).all()):
        raise bad_gltf(container.path, "an animation's times do not ascend, or a number is not finite")
    if path == "rotation" and (np.linalg.norm(triples[:, 1], axis=1) < 1e-6).any():
        raise bad_gltf(container.path, "an animation has a rotation of length 0")
    return Track(node, path, interpolation, times, triples)


def track_at(track: Track, moments: Doubles) -> Doubles:
    """Return the (M, D) values of a track at times (M,), clamped to its first and last value.

    As in glTF 2.0, appendix C, rotations are interpolated spherically along the shorter arc, or by a
    Hermite spline of their components with normalisation.
    """
    times, values = track.times, track.values[:, 1]
    turns = track.path == "rotation"
    moments = np.clip(moments, times[0], times[-1])
    after = np.searchsorted(times, moments, side="right").clip(1, max(len(times) - 1, 1))
    if len(times) == 1 or track.interpolation == "STEP":
        held = values[np.where(moments < times[-1], after - 1, len(times) - 1)]
        return _unit(held) if turns else held
    if track.interpolation == "LINEAR" and turns:
        return np.asarray(Slerp(times, Rotation.from_quat(values))(moments).as_quat(), dtype=np.float64)
    before = after - 1
    span = (times[after] - times[before])[:, None]
    s = (moments - times[before])[:, None] / span
    if track.interpolation == "LINEAR":
        return np.asarray((1 - s) * values[before] + s * values[after])
    leaving, arriving = span * track.values[before, 2], span * track.values[after, 0]
    blended: Doubles = (
        (2 * s**3 - 3 * s**2 + 1) * values[before]
        + (s**3 - 2 * s**2 + s) * leaving
        + (3 * s**2 - 2 * s**3) * values[after]
        + (s**3 - s**2) * arriving
    )
    return _unit(blended) if turns else blended


def pose_at(nodes: Nodes, clip: Clip, moment: float) -> Nodes:
    """Return the nodes at a time of a clip; nodes that it does not move stay in the rest pose."""
    moved = {"translation": nodes.translations, "rotation": nodes.rotations, "scale": nodes.scales}
    moved = {path: values.copy() for path, values in moved.items()}
    for track in clip.tracks:
        moved[track.path][track.node] = track_at(track, np.array([moment]))[0]
    return Nodes(
        nodes.parents, nodes.order, moved["translation"], moved["rotation"], moved["scale"], nodes.matrices
    )


def _unit(quaternions: Doubles) -> Doubles:
    """Return normalised quaternions (M, 4); splines can pass through 0, where any rotation will do."""
    lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
    return np.where(lengths > 1e-9, quaternions / np.maximum(lengths, 1e-9), [0.0, 0.0, 0.0, 1.0])
