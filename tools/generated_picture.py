"""Makes a sheet of drawings and, by `normalgan generate` with the package's model, their maps, also lit.

tools/generated_picture.py OUTPUT.png DRAWING…: files, folders or patterns, as `generate` takes them.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from normalgan.__main__ import main as normalgan
from normalgan.drawings import find_drawings
from normalgan.normals import read_png
from normalgan.painting.lighting import lamp_direction, shade, to_srgb

SIDE = 200
COLUMNS = 6


def square(picture: Image.Image) -> Image.Image:
    """Return a picture in the middle of a white square."""
    page = Image.new("RGBA", picture.size, "white")
    page.alpha_composite(picture.convert("RGBA"))
    page.thumbnail((SIDE, SIDE))
    whole = Image.new("RGB", (SIDE, SIDE), "white")
    whole.paste(page.convert("RGB"), ((SIDE - page.width) // 2, (SIDE - page.height) // 2))
    return whole


def main(output: Path, *given: str) -> None:
    """Write the sheet."""
    with TemporaryDirectory() as folder:
        if code := normalgan(["generate", *given, "-o", folder, "--size", str(SIDE), "--alpha"]):
            sys.exit(code)
        columns = []
        for drawing in find_drawings(given, "_normal.png", ()):
            path = Path(folder) / f"{drawing.stem}_normal.png"
            normals, alpha = read_png(path)
            clay = to_srgb(shade(normals, lamp_direction(130, 40)))
            lit = Image.fromarray(np.dstack([clay, np.uint8(255 * alpha)]))
            columns.append([square(each) for each in (Image.open(drawing), Image.open(path), lit)])
    rows = -(-len(columns) // COLUMNS)
    sheet = Image.new("RGB", (min(len(columns), COLUMNS) * SIDE, rows * 3 * SIDE), "white")
    for number, column in enumerate(columns):
        for row, picture in enumerate(column):
            sheet.paste(picture, (number % COLUMNS * SIDE, (number // COLUMNS * 3 + row) * SIDE))
    sheet.save(output)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
