"""Puts drawings and their lit maps on a contact sheet for a person to judge.

contact_sheet.py OUT [DRAWING…] [--clipart COUNT] [--seed 0] [--model shipped]

OUT.png shows each drawing with a number above its map, which is lit from the upper left. OUT.csv has a row
for each drawing: the object's share of the picture, the warning, and two columns to fill in, verdict (keep,
fix or fail) and why. A DRAWING is a file or a folder.

--clipart adds line drawings from the Debian package openclipart-svg, which is in the public domain. They are
chosen at random among grey pictures that are mostly paper, have thin lines and are not tiny. If several
names start with the same word, only one is chosen, because drawings in a series such as star_20pt differ
little.
"""

import argparse
import csv
import io
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

import normalgan
from normalgan.errors import InputError
from normalgan.files.writing import write_bytes
from normalgan.inference.outputs.lighting import lamp_direction, shade, to_srgb
from normalgan.inference.reading.picture import Picture, read_picture

CLIPART = Path("/usr/share/openclipart/svg")
SIDE, COLUMNS = 190, 12
SIZE = 512
GROUND = np.array([176, 190, 214], np.float32)


def clipart(count: int, seed: int) -> list[Path]:
    """Return random line drawings.

    Raises:
        SystemExit: if the package is not installed.
    """
    found = sorted(CLIPART.rglob("*.svg"))
    if not found:
        raise SystemExit(f"there is no clip art in {CLIPART}; apt-get install openclipart-svg")
    chosen: list[Path] = []
    words: set[str] = set()
    for number in np.random.default_rng(seed).permutation(len(found)):
        if len(chosen) == count:
            break
        word = found[number].stem.split("_")[0].split("-")[0].lower()
        if word in words:
            continue
        try:
            picture = read_picture(found[number])
        except InputError:
            continue
        if is_line_drawing(picture):
            words.add(word)
            chosen.append(found[number])
    return sorted(chosen)


def is_line_drawing(picture: Picture) -> bool:
    """Return whether a picture is grey and mostly paper, with lines and few black areas."""
    colour = on_white(picture)
    if min(colour.shape[:2]) < 100 or np.ptp(colour, axis=2).mean() > 0.01:
        return False
    share = SIZE / max(colour.shape[:2])
    grey = cv2.resize(colour.mean(2), None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
    ink = (grey < 0.5).astype(np.uint8)
    wide = cv2.erode(ink, np.ones((9, 9), np.uint8)).sum()
    return bool(0.01 < ink.mean() < 0.25 and (grey > 0.9).mean() > 0.6 and wide < 0.15 * ink.sum())


def on_white(picture: Picture) -> NDArray[np.float32]:
    """Return a picture's colours (h, w, 3) over white."""
    if picture.alpha is None:
        return picture.colour
    alpha = picture.alpha[..., None]
    return np.asarray(picture.colour * alpha + 1 - alpha, np.float32)


def drawings(given: list[Path]) -> Iterator[Path]:
    """Yield files, and the files in folders except masks."""
    for path in given:
        inside = sorted(each for each in path.iterdir() if each.is_file()) if path.is_dir() else [path]
        yield from (each for each in inside if path == each or not each.stem.endswith("_mask"))


def thumbnail(colour: NDArray[np.float32]) -> Image.Image:
    """Return a thumbnail of a picture (h, w, 3) in [0, 255], at most ``SIDE`` pixels wide and high."""
    image = Image.fromarray(np.clip(np.rint(colour), 0, 255).astype(np.uint8))
    image.thumbnail((SIDE, SIDE), Image.Resampling.LANCZOS)
    return image


def main() -> None:
    """Make the sheet."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("drawings", nargs="*", type=Path)
    parser.add_argument("--clipart", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--model", default="shipped")
    given = parser.parse_args()
    paths = [*drawings(given.drawings), *(clipart(given.clipart, given.seed) if given.clipart else [])]
    if not paths:
        raise SystemExit("give drawings, or --clipart.")
    predictor = normalgan.load(given.model)
    lamp = lamp_direction(130, 40)
    rows = -(-len(paths) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SIDE, rows * 2 * SIDE), "white")
    pen = ImageDraw.Draw(sheet)
    table = io.StringIO()
    writer = csv.writer(table)
    writer.writerow(["number", "drawing", "object", "warning", "verdict", "why"])
    for number, path in enumerate(paths):
        left, top = number % COLUMNS * SIDE, number // COLUMNS * 2 * SIDE
        share, warning = 0.0, ""
        try:
            sheet.paste(thumbnail(255 * on_white(read_picture(path))), (left, top))
            result = predictor(path, size=SIZE)
        except InputError as error:
            warning = str(error)
        else:
            lit = np.where(result.mask[..., None], to_srgb(shade(result.normal, lamp)), GROUND)
            sheet.paste(thumbnail(lit), (left, top + SIDE))
            share, warning = float(result.mask.mean()), result.warning
        pen.text((left + 3, top + 2), str(number), fill=(200, 30, 30))
        writer.writerow([number, path.name, f"{share:.3f}", warning, "", ""])
        print(number, path.name, warning, flush=True)
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG")
    write_bytes(given.out.with_suffix(".png"), buffer.getvalue())
    write_bytes(given.out.with_suffix(".csv"), table.getvalue().encode())


if __name__ == "__main__":
    main()
