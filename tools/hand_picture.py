"""Makes the picture of the hand's strengths from embedded animals: tools/hand_picture.py PATH."""

import sys
from pathlib import Path

import numpy as np
from pictures import Picture, colours, panels

from normalgan.animals import Animal
from normalgan.files.writing import write_bytes
from normalgan.rendering import EmbreeRenderer
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.maps import Maps
from normalgan.rendering.strokes.raster import rasterise
from normalgan.rendering.view import View
from normalgan.rendering.views import framed, look_at_origin

SIZE = 140
COLUMNS = [(0.0, 0), (0.25, 1), (0.5, 2), (1.0, 3), (1.0, 4), (1.0, 5)]
"""Strength and seed of the drawings."""
ANIMALS = [
    (Animal("horse", 2), 30.0),
    (Animal("lion", 3), -50.0),
    (Animal("elephant", 1), -35.0),
    (Animal("cat", 1), 100.0),
]
"""The animals and from what azimuth they are seen."""


def draw(view: View, strength: float, seed: int) -> tuple[Picture, Maps]:
    """Return a drawing (H, W), paper 1 and ink 0, and the maps that go with it."""
    strokes = SuggestiveContours().trace(view, np.random.default_rng(0))
    hand = Hand(strength=(strength, strength))
    drawn, maps = hand.draw(strokes, view.maps(), np.random.default_rng(seed))
    return 1 - rasterise(drawn, view.size).astype(np.float64), maps


def picture() -> bytes:
    """Return the animals in rows and the strengths in columns, and last the normals of the last drawing."""
    rows = []
    for animal, azimuth in ANIMALS:
        mesh = animal.load()
        camera = framed(mesh.vertices, look_at_origin(azimuth, 8.0, 0.0), None, 0.06)
        view = View(mesh, camera, EmbreeRenderer(), SIZE)
        drawings = [draw(view, strength, seed) for strength, seed in COLUMNS]
        rows.append([*(drawing for drawing, _ in drawings), colours(drawings[-1][1])])
    titles = ["strength 0", *(f"{strength:g}" for strength, _ in COLUMNS[1:]), "the last one's normals"]
    return panels(rows, [titles, *([""] * len(titles) for _ in rows[1:])], SIZE)


if __name__ == "__main__":
    path = Path(sys.argv[1]) if len(sys.argv) == 2 else sys.exit("usage: tools/hand_picture.py PATH")
    write_bytes(path, picture())
    print(path, f"{path.stat().st_size // 1024} kB")
