"""Makes docs/pictures/variation.png from embedded animals: tools/variation_picture.py FILE.

Given a folder of meshes too, it draws a contact sheet of 64 of their individuals and poses instead:
tools/variation_picture.py FILE FOLDER [POSES].
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.animals import Animal
from normalgan.normals import encode, paint_flat
from normalgan.rendering import EmbreeRenderer, Mesh, MeshSource, find_meshes
from normalgan.rendering.rigs import find_poses
from normalgan.rendering.variation import Variation, Varied
from normalgan.rendering.views import framed, look_at_origin

SIDE, COLUMNS, COUNT = 120, 8, 64
SPECIES = ("horse", "cat", "elephant", "stag")


def tile(mesh: Mesh) -> NDArray[np.uint8]:
    """Return a mesh's normal map, seen from its side, (SIDE, SIDE, 3)."""
    # Forward is the longer of the level axes: +X for embedded animals, +Z for many files.
    forward_z = np.ptp(mesh.vertices[:, 2]) > np.ptp(mesh.vertices[:, 0])
    camera = framed(mesh.vertices, look_at_origin(-60.0 if forward_z else 25.0, 12.0, 0.0), None, 0.04)
    maps = EmbreeRenderer().render(mesh, camera, SIDE)
    return np.asarray(encode(paint_flat(maps.normal, maps.mask)), dtype=np.uint8)


def sheet(meshes: Sequence[Mesh]) -> Image.Image:
    """Return a contact sheet, COLUMNS wide."""
    tiles = [tile(mesh) for mesh in meshes]
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % COLUMNS)
    rows = [np.concatenate(tiles[i : i + COLUMNS], axis=1) for i in range(0, len(tiles), COLUMNS)]
    return Image.fromarray(np.concatenate(rows, axis=0))


def embedded() -> list[Mesh]:
    """Return two rows of each of four animals, each animal itself first."""
    meshes: list[Mesh] = []
    for species in SPECIES:
        animal = Animal(species, 1)
        meshes += [animal.load(), *(Varied(animal, Variation(), k).load() for k in range(COUNT // 4 - 1))]
    return meshes


def found(folder: str, poses: int) -> list[Mesh]:
    """Return COUNT individuals of the meshes of a folder, in turn, or as many poses of each as asked for."""
    sources: list[MeshSource] = [*find_poses(find_meshes(folder), poses)]
    if poses:
        return [source.load() for source in sources[:: max(1, len(sources) // COUNT)][:COUNT]]
    picked = [sources[i % len(sources)] for i in range(COUNT)]
    return [Varied(source, Variation(), i).load() for i, source in enumerate(picked)]


if __name__ == "__main__":
    if len(sys.argv) not in {2, 3, 4}:
        sys.exit("usage: tools/variation_picture.py FILE [FOLDER [POSES]]")
    meshes = embedded() if len(sys.argv) == 2 else found(sys.argv[2], int((*sys.argv, "0")[3]))
    sheet(meshes).quantize(224).save(sys.argv[1], optimize=True)
    print(sys.argv[1], f"{Path(sys.argv[1]).stat().st_size // 1024} kB")
