"""Makes a sheet of drawings with their maps from `normalgan generate`, also lit.

generated_picture.py OUTPUT DRAWING… [--predicted 200] [--shown 200] [--columns 6]

Drawings are files, folders or patterns, as for `generate`. --predicted is the longer side of the maps, and
--shown is that of their pictures on the sheet.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from normalgan.__main__ import main as normalgan
from normalgan.inference.conversion import read_map
from normalgan.inference.jobs.folders import find_drawings
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb


def square(picture: Image.Image, side: int) -> Image.Image:
    """Return a picture centred on a white square."""
    page = Image.new("RGBA", picture.size, "white")
    page.alpha_composite(picture.convert("RGBA"))
    page.thumbnail((side, side))
    whole = Image.new("RGB", (side, side), "white")
    whole.paste(page.convert("RGB"), ((side - page.width) // 2, (side - page.height) // 2))
    return whole


def predicted(drawings: list[str], size: int) -> Iterator[tuple[Image.Image, Image.Image]]:
    """Yield the map of each drawing, and the lit map."""
    with TemporaryDirectory() as folder:
        if code := normalgan(["generate", *drawings, "-o", folder, "--size", str(size), "--alpha"]):
            sys.exit(code)
        for drawing in find_drawings(drawings, "_normal.png", ()):
            path = Path(folder) / f"{drawing.stem}_normal.png"
            clay = to_srgb(shade(read_map(path).extended, lamp_direction(130, 40)))
            with Image.open(path) as picture:
                yield picture.copy(), Image.fromarray(np.dstack([clay, np.asarray(picture)[..., 3]]))


def main(arguments: list[str]) -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("drawings", nargs="+")
    parser.add_argument("--predicted", type=int, default=200)
    parser.add_argument("--shown", type=int, default=200)
    parser.add_argument("--columns", type=int, default=6)
    given = parser.parse_args(arguments)
    side = given.shown
    columns = [
        [square(Image.open(drawing), side)] for drawing in find_drawings(given.drawings, "_normal.png", ())
    ]
    for column, pictures in zip(columns, predicted(given.drawings, given.predicted), strict=True):
        column += [square(each, side) for each in pictures]
    rows, pictures_each = -(-len(columns) // given.columns), len(columns[0])
    sheet = Image.new("RGB", (min(len(columns), given.columns) * side, rows * pictures_each * side), "white")
    for number, column in enumerate(columns):
        for row, picture in enumerate(column):
            place = number % given.columns * side, (number // given.columns * pictures_each + row) * side
            sheet.paste(picture, place)
    sheet.save(given.output, quality=88, method=6)  # PNG ignores these


if __name__ == "__main__":
    main(sys.argv[1:])
