"""Clips: the frames of an animation as meshes in a fixed coordinate system, for one camera."""

from functools import cached_property
from pathlib import Path

import numpy as np

from normalgan.arrays import Doubles, Indices
from normalgan.errors import InputError, did_you_mean
from normalgan.rendering.gltf.scene import world_matrices
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile, place
from normalgan.rendering.rigs.animations import pose_at
from normalgan.rendering.rigs.reading import read_rig
from normalgan.rendering.rigs.rig import Clip, posed_surface

_MOMENTS = 16
"""Number of times for estimating the bounding box of a whole clip."""


class ClipMeshes:
    """Sampled times of one clip of a rigged glTF file.

    All meshes are moved and scaled in the same way, by the bounding box of the whole clip, so still parts
    do not move.

    Args:
        file: rigged file with its orientation.
        clip: name of the clip, or only the part after the last ``|``, or its index from 0.

    Raises:
        InputError: if the file has no rig or no such clip.
    """

    def __init__(self, file: MeshFile, clip: str) -> None:
        self._file = file
        self._rig = read_rig(Path(file.path))
        self.clip: Clip = _find(self._rig.clips, clip, file.path)

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time in seconds."""
        return self.clip.span

    def mesh(self, moment: float) -> Mesh:
        """Return the mesh at a time in seconds."""
        return place(self._file.name, self._file, *self._surface(moment), self._about)[0]

    @cached_property
    def hull(self) -> Doubles:
        """(K, 3) vertices of all meshes of the clip, which the frame of a view must contain."""
        return np.concatenate([self.mesh(moment).vertices for moment in self._moments]).astype(np.float64)

    @cached_property
    def _moments(self) -> list[float]:
        return [float(moment) for moment in np.linspace(*self.span, _MOMENTS)]

    @cached_property
    def _about(self) -> Doubles:
        return np.concatenate([self._surface(moment)[0] for moment in self._moments])

    def _surface(self, moment: float) -> tuple[Doubles, Indices]:
        return posed_surface(self._rig, world_matrices(pose_at(self._rig.nodes, self.clip, moment)))


def _find(clips: tuple[Clip, ...], wanted: str, path: str) -> Clip:
    names = [clip.name.rpartition("|")[2] or str(number) for number, clip in enumerate(clips)]
    if not clips:
        raise InputError(f"{path} has no animation; a clip is of a rigged glTF file that has some.")
    for number, (name, clip) in enumerate(zip(names, clips, strict=True)):
        if wanted in {name, clip.name, str(number)}:
            return clip
    raise InputError(
        f"{path} has no clip {wanted!r}.{did_you_mean(wanted, names)} Its clips: {', '.join(names)}."
    )
