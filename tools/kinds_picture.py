"""Makes a contact sheet of 64 embedded animals of all groups: tools/kinds_picture.py docs/pictures/kinds.png.

With names of species and groups behind, it draws 64 of those instead, one seed after the other.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from normalgan.animals import GROUPS, Animal, make_animals
from normalgan.normals import encode, paint_flat
from normalgan.rendering import EmbreeRenderer
from normalgan.rendering.views import framed, look_at_origin

SIDE, COLUMNS, COUNT = 88, 8, 64
AZIMUTH, ELEVATION = 32.0, 16.0  # from the right and a little above, so that rays and lizards show as well


def assortment() -> list[Animal]:
    """Return 64 species, as many of each group as of any other while they last, in the groups' order."""
    rounds = max(len(names) for names in GROUPS.values())
    dealt = [name for i in range(rounds) for names in GROUPS.values() for name in names[i : i + 1]][:COUNT]
    return [Animal(name, 1) for names in GROUPS.values() for name in names if name in dealt]


def tile(animal: Animal) -> NDArray[np.uint8]:
    """Return an animal's normal map, (SIDE, SIDE, 3)."""
    mesh = animal.load()
    camera = framed(mesh.vertices, look_at_origin(AZIMUTH, ELEVATION, 0.0), None, 0.04)
    maps = EmbreeRenderer().render(mesh, camera, SIDE)
    return np.asarray(encode(paint_flat(maps.normal, maps.mask)), dtype=np.uint8)


def sheet(animals: Sequence[Animal]) -> Image.Image:
    """Return a contact sheet, COLUMNS wide."""
    tiles = [tile(animal) for animal in animals]
    rows = [np.concatenate(tiles[i : i + COLUMNS], axis=1) for i in range(0, len(tiles), COLUMNS)]
    return Image.fromarray(np.concatenate(rows, axis=0))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: tools/kinds_picture.py FILE [SPECIES OR GROUP ...]")
    names = sys.argv[2:]
    path = Path(sys.argv[1])
    sheet(make_animals(COUNT, seed=1, species=names) if names else assortment()).save(path, optimize=True)
    print(path, f"{path.stat().st_size // 1024} kB")
