"""Makes the picture of all line styles, and of drawings by people: tools/styles_picture.py FILE [FOLDER]."""

import sys
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from normalgan.animals import Animal
from normalgan.files.writing import write_bytes
from normalgan.rendering import EmbreeRenderer
from normalgan.rendering.lines import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.strokes import rasterise
from normalgan.rendering.view import View
from normalgan.rendering.views import framed, look_at_origin

Picture = NDArray[np.floating]

ORDER = (
    "Silhouette",
    "OccludingContours",
    "SuggestiveContours",
    "ObjectSpaceSuggestive",
    "RidgesAndValleys",
    "Brush",
)
SEEN = (
    (Animal("lion", 3), 25.0, 10.0, None),
    (Animal("horse", 2), -30.0, 5.0, 35.0),
    (Animal("elephant", 1), 20.0, 10.0, None),
    (Animal("cat", 1), 60.0, 20.0, 40.0),
)
"""Which animal, from what azimuth and elevation, and under what field of view, all in degrees."""
PEOPLES = (
    "leone_01_architetto_fran_01__line",
    "cavallo_architetto_franc_02__line",
    "cavallo_architetto_franc_05__line",
    "dog_05_drawn_with_strai_01__line",
    "contour_elephant__outline",
    "fawn_mo_01__outline",
)
"""Drawings from openclipart.org, in the public domain."""
SIDE, TITLE, DPI = 224, 22, 100


def styles() -> dict[str, LineDrawing]:
    """Return every registered style but the mixture, as it is by default.

    Raises:
        SystemExit: if there is one that this file does not know.
    """
    known = {kind.__name__: kind for kind in LINE_DRAWINGS if kind.__name__ != "Mixture"}
    if set(known) != set(ORDER):
        sys.exit(f"the picture shows {', '.join(ORDER)}; there are {', '.join(known)}")
    return {name: known[name]() for name in ORDER}


def drawn(animal: Animal, azimuth: float, elevation: float, field_of_view: float | None) -> list[Picture]:
    """Return the sketches (SIDE, SIDE) of an animal in every style, paper 1 and ink 0."""
    mesh = animal.load()
    camera = framed(mesh.vertices, look_at_origin(azimuth, elevation, 0.0), field_of_view, 0.05)
    view = View(mesh, camera, EmbreeRenderer(), SIDE)
    rng = np.random.default_rng(0)
    return [1 - rasterise(style.trace(view, rng), SIDE) for style in styles().values()]


def peoples(folder: Path) -> list[Picture]:
    """Return the drawings by people in a folder, as large as ours."""
    pictures: list[Picture] = []
    for name in PEOPLES:
        grey = cv2.imread(str(folder / f"{name}.png"), cv2.IMREAD_GRAYSCALE)
        if grey is None:
            sys.exit(f"{folder / name}.png is not there or no picture")
        pictures.append(cv2.resize(grey, (SIDE, SIDE), interpolation=cv2.INTER_AREA) / 255)
    return pictures


def sheet(rows: list[tuple[list[str], list[Picture]]]) -> bytes:
    """Return rows of pictures, each row under its titles, as a PNG."""
    height = sum(SIDE + TITLE * any(names) for names, _ in rows)
    width = SIDE * len(ORDER)
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    bottom = height
    for names, pictures in rows:
        bottom -= SIDE + TITLE * any(names)
        for column, (name, picture) in enumerate(zip(names, pictures, strict=True)):
            axes = figure.add_axes((column * SIDE / width, bottom / height, SIDE / width, SIDE / height))
            axes.imshow(picture, cmap="gray", vmin=0, vmax=1, interpolation="nearest")
            axes.set_axis_off()
            axes.set_title(name, fontsize=9, pad=5)
    coloured, grey = BytesIO(), BytesIO()
    figure.savefig(coloured, format="png", dpi=DPI)
    # Sixteen greys: a third of the bytes, and nothing to see of it.
    Image.open(coloured).convert("L").quantize(16).save(grey, format="png", optimize=True)
    return grey.getvalue()


if __name__ == "__main__":
    if len(sys.argv) not in {2, 3}:
        sys.exit("usage: tools/styles_picture.py FILE [FOLDER OF DRAWINGS]")
    blank = [""] * len(ORDER)
    rows = [(list(ORDER) if k == 0 else blank, drawn(*seen)) for k, seen in enumerate(SEEN)]
    if len(sys.argv) == 3:
        rows.append((["by people, to compare:", *blank[1:]], peoples(Path(sys.argv[2]))))
    path = Path(sys.argv[1])
    write_bytes(path, sheet(rows))
    print(path, f"{path.stat().st_size // 1024} kB")
