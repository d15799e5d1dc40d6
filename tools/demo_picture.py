"""Compares maps of the demo's small model with those of the shipped model: demo_picture.py RUN DRAWINGS.

RUN is the folder of a run with the ``predictions`` that `predict` wrote; the picture goes to RUN/demo.png.
"""

import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pictures import DPI, png
from PIL import Image

from normalgan.__main__ import main as normalgan
from normalgan.files.writing import write_bytes
from normalgan.inference.conversion import read_map
from normalgan.inference.jobs.folders import find_drawings
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb
from normalgan.normals import encode, paint_flat

SIDE = 180  # side of a cell in pixels
MARGIN = 110  # pixels at the left for the names of the rows


def map_and_lit(path: Path) -> list[NDArray[np.uint8]]:
    """Return the colours of a normal map and the lit map, both on white."""
    found = read_map(path)
    normals, alpha = found.extended, found.alpha
    if found.mask.all():  # as `predict` writes: flat off the object
        alpha = (np.abs(normals - (0, 0, 1)).max(-1) > 0.01).astype(np.float32)
    clay = to_srgb(shade(normals, lamp_direction(130, 40)))
    lit = 255 + alpha[..., None] * (clay - 255.0)
    return [encode(paint_flat(normals, alpha > 0.5)).astype(np.uint8), lit.astype(np.uint8)]


def main(arguments: list[str]) -> int:
    """Write the picture."""
    run, drawings = Path(arguments[0]), arguments[1:]
    names = [drawing.stem for drawing in find_drawings(drawings, "_normal.png", ())]
    with TemporaryDirectory() as folder:
        with redirect_stdout(StringIO()):  # suppresses the names of temporary files
            code = normalgan(["generate", *drawings, "-o", folder, "--size", "256", "--alpha"])
        if code:
            return code
        columns = [
            [
                np.asarray(Image.open(Path(drawings[0]) / f"{name}.png").convert("RGB")),
                *map_and_lit(run / "predictions" / f"{name}_normal.png"),
                *map_and_lit(Path(folder) / f"{name}_normal.png"),
            ]
            for name in names
        ]
    rows = ["drawing", "demo model\n(64 pixels,\n2 minutes)", "lit", "shipped model\n(256 pixels)", "lit"]
    width, height = MARGIN + SIDE * len(columns), SIDE * len(rows)
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    for i, name in enumerate(rows):
        middle = 1 - (i + 0.5) / len(rows)
        figure.text(MARGIN / 2 / width, middle, name, ha="center", va="center", fontsize=9)
        for j, column in enumerate(columns):
            box = ((MARGIN + j * SIDE) / width, middle - 0.5 / len(rows), SIDE / width, 1 / len(rows))
            axes = figure.add_axes(box)
            axes.imshow(column[i], interpolation="nearest")
            axes.set_axis_off()
    write_bytes(run / "demo.png", png(figure))
    print(f"Drawings, maps of the demo's model and of the shipped model: {run / 'demo.png'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
