"""Adds clip art to the cache of views: drawings by people whose opacity marks the object.

clipart.py OUT [--leave-out FOLDER SHEET.csv…]

The drawings come from the Debian package openclipart-svg and are in the public domain. To reserve drawings
for tests, give their FOLDER or the table of a sheet by contact_sheet.py. It leaves them out, together with
all drawings whose names begin with the same word.
"""

import argparse
import csv
import io
import json
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import resvg_py
from numpy.typing import NDArray
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from contact_sheet import CLIPART
from shapes import Points, smoothed
from views import CHUNK, POINT

SIZE = 384
_NO_OBJECTS = (
    *("flags", "gradients", "patterns", "aiga", "map_symbols", "roadsigns", "cards", "jigsaw", "led"),
    *("action", "filesystems"),
)
"""The package's folders to read."""
_OF_A_SERIES = 12
"""Maximum number of drawings whose names begin with the same word."""
_MOST_INSIDE = 300
"""Maximum number of lines inside a drawing."""
_DARK = 80
"""Darker pixels count as lines; clip art has black outlines or none."""


def first_word(stem: str) -> str:
    """Return the first word of a file's name, which all drawings of a series share."""
    return re.split(r"[_\-0-9]", stem.removeprefix("openclipart_").removeprefix("contour_").lower())[0]


def names_in(path: Path) -> list[str]:
    """Return the names of drawings in a folder, or on a sheet of contact_sheet.py, without their suffixes."""
    if path.is_dir():
        return [each.stem for each in path.iterdir()]
    with path.open(newline="") as file:
        return [Path(row["drawing"]).stem for row in csv.DictReader(file)]


def rendered(path: Path) -> NDArray[np.uint8] | None:
    """Return a centred drawing (SIZE, SIZE, 4), RGBA; None if its opacity does not mark an object."""
    if path.stat().st_size > 1_500_000:
        return None
    try:
        made = resvg_py.svg_to_bytes(svg_string=path.read_text(errors="replace"), width=2 * SIZE)
        image = Image.open(io.BytesIO(bytes(made))).convert("RGBA")
    except KeyboardInterrupt:
        raise
    except BaseException:  # resvg panics on some files, and a panic is not an Exception
        return None
    box = image.getchannel("A").point(lambda value: 255 * (value > 127)).getbbox()
    if box is None or max(image.size) > 4000:
        return None
    image = image.crop(box)
    share = (SIZE - 16) / max(image.size)
    if share > 4 or min(image.size) * share < 24:
        return None
    width, height = (max(round(side * share), 1) for side in image.size)
    image = image.resize((width, height), Image.Resampling.BOX if share < 1 else Image.Resampling.BICUBIC)
    whole = Image.new("RGBA", (SIZE, SIZE), (255, 255, 255, 0))
    whole.paste(image, ((SIZE - width) // 2, (SIZE - height) // 2))
    return np.asarray(whole)


def tells_its_object(drawn: NDArray[np.uint8]) -> bool:
    """Return whether a drawing's opacity marks its object, instead of only lines or a picture's rectangle."""
    opaque = (drawn[..., 3] > 127).astype(np.uint8)
    if ((drawn[..., 3] > 20) & (drawn[..., 3] < 235)).mean() > 0.06:  # shadows, glass
        return False
    colour = drawn[..., :3][opaque > 0].astype(int)
    dark = (colour.max(1) < _DARK).mean()
    box = cv2.boundingRect(opaque)
    if opaque.sum() > 0.985 * box[2] * box[3]:
        return False
    outer, _ = cv2.findContours(np.pad(opaque, 1), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    filled = np.zeros((SIZE + 2, SIZE + 2), np.uint8)
    cv2.drawContours(filled, outer, -1, 1, -1)
    hollow = 1 - opaque.sum() / filled.sum()
    # Lines that enclose nothing opaque are not filled: the enclosed area may belong to the object.
    solid = cv2.erode(opaque, np.ones((9, 9), np.uint8)).sum() / opaque.sum()
    return bool(opaque.mean() > 0.03 and dark < 0.7 and hollow < 0.3 and solid > 0.45 and len(outer) < 12)


def lines_of(drawn: NDArray[np.uint8]) -> tuple[list[Points], int, bool]:
    """Return strokes in pixels, the number of outlines, and whether dark lines bound the object."""
    opaque = (drawn[..., 3] > 127).astype(np.uint8)
    colour = np.asarray(cv2.bilateralFilter(np.ascontiguousarray(drawn[..., :3]), 5, 40, 3), np.uint8)
    dark = ((colour.max(2) < _DARK) & (opaque > 0)).astype(np.uint8)
    rim = opaque > cv2.erode(opaque, np.ones((3, 3), np.uint8), borderValue=0)
    lined = bool(cv2.dilate(dark, np.ones((5, 5), np.uint8))[rim].mean() > 0.85)
    found, _ = cv2.findContours(opaque, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    outlines = [_stroke(np.concatenate([c[:, 0], c[:1, 0]])) for c in found if len(c) > 12]
    regions = _regions(colour, (dark == 0) & (opaque > 0)) * opaque
    return outlines + _borders(regions)[:_MOST_INSIDE], len(outlines), lined


def _regions(colour: NDArray[np.uint8], free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return for each pixel the number of the nearest uniform area; areas lie only in ``free`` pixels."""
    codes = np.where(free, (colour.astype(int) >> 6) @ np.array([16, 4, 1]) + 1, 0)
    regions = np.zeros(codes.shape, np.int32)
    for code in np.unique(codes[free]):
        count, parts, stats, _ = cv2.connectedComponentsWithStats(
            (codes == code).astype(np.uint8), connectivity=4
        )
        for k in range(1, count):
            if stats[k, cv2.CC_STAT_AREA] > 60:
                regions[parts == k] = regions.max() + 1
    if not regions.any():
        return regions
    _, nearest = cv2.distanceTransformWithLabels(
        (regions == 0).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    table = np.zeros(nearest.max() + 1, np.int32)
    table[nearest[regions > 0]] = regions[regions > 0]
    return table[nearest]


def _borders(regions: NDArray[np.int32]) -> list[Points]:
    """Return each line between two regions once, along the region with the lower number."""
    borders = []
    for number in range(1, regions.max() + 1):
        found, _ = cv2.findContours(
            (regions == number).astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE
        )
        greater = cv2.dilate(regions.astype(np.float32), np.ones((3, 3), np.uint8)) > number
        for contour in found:
            points = contour[:, 0]
            keep = greater[points[:, 1], points[:, 0]]
            ends = np.flatnonzero(np.diff(np.concatenate([[0], keep.view(np.int8), [0]])))
            borders += [_stroke(points[a:b]) for a, b in ends.reshape(-1, 2) if b - a > 14]
    return borders


def _stroke(pixels: NDArray[np.int32]) -> Points:
    path = smoothed(pixels.astype(np.float32) + 0.5, closed=False)
    return np.concatenate([path[:-1:2], path[-1:]])


def main() -> None:
    """Write the clip art whose opacity marks its object."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--leave-out", type=Path, nargs="*", default=[])
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    unseen = {first_word(name) for path in given.leave_out for name in names_in(path)}
    series: Counter[str] = Counter()
    arrays: dict[str, NDArray[Any]] = {}
    names: list[str] = []
    files = sorted(CLIPART.rglob("*.svg"))
    written = 0
    for number in np.random.default_rng(0).permutation(len(files)):
        path = files[number]
        word = first_word(path.stem)
        where = path.relative_to(CLIPART).parts
        if word in unseen or any(part.startswith(_NO_OBJECTS) for part in where):
            continue
        if series[word] == _OF_A_SERIES:
            continue
        drawn = rendered(path)
        if drawn is None or not tells_its_object(drawn):
            continue
        series[word] += 1
        strokes, outlines, lined = lines_of(drawn)
        key = len(names)
        names.append(f"clipart/{word}/{path.stem}")
        arrays |= {
            f"{key}.mask": np.packbits(drawn[..., 3] > 127),
            f"{key}.points": np.rint(np.concatenate(strokes) * POINT).astype(np.int16),
            f"{key}.lengths": np.array([len(stroke) for stroke in strokes], np.int32),
            f"{key}.outlines": np.array(outlines, np.int32),
            f"{key}.paint": cv2.imencode(".png", cv2.cvtColor(drawn, cv2.COLOR_RGBA2BGRA))[1],
            f"{key}.lined": np.array(lined),
        }
        if len(names) == CHUNK:
            _write(given.out, written, names, arrays)
            arrays, names, written = {}, [], written + 1
    _write(given.out, written, names, arrays)


def _write(out: Path, number: int, names: list[str], arrays: dict[str, NDArray[Any]]) -> None:
    temporary = out / f".clipart_{number:02d}.npz"
    np.savez(temporary, allow_pickle=False, names=json.dumps(names), **arrays)
    temporary.replace(out / f"views_clipart_{number:02d}.npz")
    print(number, len(names), flush=True)


if __name__ == "__main__":
    main()
