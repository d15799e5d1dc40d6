"""RiggedFile: a pose of a rigged glTF file as a mesh; finding the poses of all rigged mesh files."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from normalgan.errors import InputError
from normalgan.ranges import Count, UnitInterval, check_ranges
from normalgan.rendering.gltf.container import bad_gltf, has_skin
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile, place
from normalgan.seeds import rng_of

_RIG_VERSION = 2
"""Version in each fingerprint. Increase it if a pose number gives a different pose than before."""
_POSTURES_VERSION = 1
"""Version in fingerprints with postures. Increase it if the table of postures changes."""


@dataclass(frozen=True)
class RiggedFile:
    """A random pose of a rigged glTF file, determined by its number; a `MeshSource`.

    Args:
        file: file with its orientation; its crease angle also applies to the pose.
        pose: number of the pose, from 0; the pose depends only on this and on the file's name.
        postures: fraction of the poses, from 0 to 1, that are postures such as sitting or lying, if the
            skeleton is known.
    """

    file: MeshFile
    pose: Count
    postures: UnitInterval = 0.0

    def __post_init__(self) -> None:
        check_ranges(self)

    @property
    def name(self) -> str:
        """The file name without extension, and the number: ``horse@3``."""
        return f"{self.file.name}@{self.pose}"

    def fingerprint(self) -> str:
        """Return a hash of the file's bytes, of the files that it refers to, and of the settings.

        Raises:
            InputError: if the file cannot be read.
        """
        # Without postures, the fingerprint must stay the same, because existing samples are stored under
        # it.
        share = [_POSTURES_VERSION, self.postures] if self.postures else []
        settings = json.dumps([_RIG_VERSION, self.pose, self.file.fingerprint(), *share])
        return hashlib.sha256(settings.encode()).hexdigest()

    def load(self) -> Mesh:
        """Return the pose as a mesh, prepared as in `MeshFile.load`.

        Raises:
            InputError: if the file cannot be read, or its rig is inconsistent.
        """
        # importing scipy takes half a second, only needed to pose rigs
        from normalgan.rendering.rigs.joints import LooseRigError
        from normalgan.rendering.rigs.posing import draw_pose
        from normalgan.rendering.rigs.reading import read_rig
        from normalgan.rendering.rigs.rig import posed_surface

        rig = read_rig(Path(self.file.path))
        rng = rng_of(self.file.name, self.pose)
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                vertices, faces = posed_surface(rig, draw_pose(rig, rng, self.postures))
            except LooseRigError as error:
                raise bad_gltf(Path(self.file.path), str(error)) from error
        if not np.isfinite(vertices).all():
            raise bad_gltf(Path(self.file.path), f"pose {self.pose} moves vertices to infinity")
        return place(self.name, self.file, vertices, faces)[0]


def find_poses(files: Sequence[MeshFile], poses: int, postures: float = 0.0) -> list[MeshFile | RiggedFile]:
    """Return mesh files, with each rigged file replaced by ``poses`` poses; 0 keeps all in the rest pose.

    Raises:
        InputError: if the number is negative.
    """
    if poses < 0:
        raise InputError(f"poses is {poses}; it is the number of poses of each rigged file, 0 or more.")
    found: list[MeshFile | RiggedFile] = []
    for file in files:
        if poses and has_skin(Path(file.path)):
            found += [RiggedFile(file, pose, postures) for pose in range(poses)]
        else:
            found.append(file)
    return found
