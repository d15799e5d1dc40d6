"""Adds clip art to the cache of views: drawings by people whose opacity says what is object.

clipart.py OUT [--leave-out FOLDER SHEET.csv…]

It takes the Debian package openclipart-svg, which is in the public domain. What is in a FOLDER or on a sheet
of contact_sheet.py is left out, and so is what begins with the same word, so that they stay unseen.
"""

import argparse
import csv
import io
import json
import re
import sys
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import resvg_py
from numpy.typing import NDArray
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from contact_sheet import CLIPART
from views import CHUNK, POINT

SIZE = 384
_NO_OBJECTS = (
    *("flags", "gradients", "patterns", "aiga", "map_symbols", "roadsigns", "cards", "jigsaw", "led"),
    *("action", "filesystems"),
)
"""Folders of the package."""
_OF_A_SERIES = 12
_DARK = 80
"""Darker pixels are lines; clip art has black outlines or none."""


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
    """Return a drawing (SIZE, SIZE, 4), RGBA, in the middle; None if its opacity does not tell an object."""
    if path.stat().st_size > 1_500_000:
        return None
    try:
        made = resvg_py.svg_to_bytes(svg_string=path.read_text(errors="replace"), width=2 * SIZE)
        image = Image.open(io.BytesIO(bytes(made))).convert("RGBA")
    except KeyboardInterrupt:
        raise
    except BaseException:  # resvg panics on some files, and a panic is no Exception
        return None
    box = image.getchannel("A").point(lambda value: 255 * (value > 127)).getbbox()
    if box is None or max(image.size) > 4000:
        return None
    image = image.crop(box)
    share = (SIZE - 16) / max(image.size)
    if share > 4 or min(image.size) * share < 24:
        return None
    image = image.resize(
        [max(round(side * share), 1) for side in image.size],
        Image.Resampling.BOX if share < 1 else Image.Resampling.BICUBIC,
    )
    whole = Image.new("RGBA", (SIZE, SIZE), (255, 255, 255, 0))
    whole.paste(image, [(SIZE - side) // 2 for side in image.size])
    return np.asarray(whole)


def tells_its_object(drawn: NDArray[np.uint8]) -> bool:
    """Return whether the opacity of a drawing is its object, and not lines alone or a picture's rectangle."""
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
    # Lines that enclose nothing opaque are not filled: what they enclose may be object.
    solid = cv2.erode(opaque, np.ones((9, 9), np.uint8)).sum() / opaque.sum()
    return bool(opaque.mean() > 0.03 and dark < 0.7 and hollow < 0.3 and solid > 0.45 and len(outer) < 12)


def lines_of(drawn: NDArray[np.uint8]) -> tuple[list[NDArray[np.float32]], int, bool]:
    """Return strokes in pixels, how many are outlines, and whether dark lines bound the object."""
    opaque = (drawn[..., 3] > 127).astype(np.uint8)
    colour = cv2.bilateralFilter(np.ascontiguousarray(drawn[..., :3]), 5, 40, 3)
    dark = ((colour.max(2) < _DARK) & (opaque > 0)).astype(np.uint8)
    inner = cv2.erode(opaque, np.ones((3, 3), np.uint8), borderValue=0)
    rim = (opaque > inner) > 0
    near = cv2.dilate(dark, np.ones((5, 5), np.uint8))
    lined = bool(near[rim].mean() > 0.85)
    outlines = []
    found, _ = cv2.findContours(opaque, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    for contour in found:
        if len(contour) > 12:
            points = contour[:, 0].astype(np.float32) + 0.5
            outlines.append(_smooth(np.concatenate([points, points[:1]])))
    codes = (colour.astype(int) >> 6) @ np.array([16, 4, 1]) + 1
    codes[(dark > 0) | (opaque == 0)] = 0
    labels = np.zeros(codes.shape, np.int32)
    for code in np.unique(codes[codes > 0]):
        count, parts, stats, _ = cv2.connectedComponentsWithStats(
            (codes == code).astype(np.uint8), connectivity=4
        )
        for k in range(1, count):
            if stats[k, cv2.CC_STAT_AREA] > 60:
                labels[parts == k] = labels.max() + 1
    if not labels.any():
        return outlines, len(outlines), lined
    _, nearest = cv2.distanceTransformWithLabels(
        (labels == 0).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    table = np.zeros(nearest.max() + 1, np.int32)
    table[nearest[labels > 0]] = labels[labels > 0]
    labels = table[nearest] * opaque
    inside = []
    for label in range(1, labels.max() + 1):
        found, _ = cv2.findContours((labels == label).astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
        greater = cv2.dilate(labels.astype(np.float32), np.ones((3, 3), np.uint8)) > label
        for contour in found:
            points = contour[:, 0]
            keep = greater[points[:, 1], points[:, 0]]
            edges = np.flatnonzero(np.diff(np.concatenate([[0], keep.view(np.int8), [0]])))
            for a, b in edges.reshape(-1, 2):
                if b - a > 14:
                    inside.append(_smooth(points[a:b].astype(np.float32) + 0.5))
    return outlines + inside[:300], len(outlines), lined


def _smooth(path: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a path without the staircase of its pixels, with half its points."""
    around = np.concatenate([np.repeat(path[:1], 3, 0), path, np.repeat(path[-1:], 3, 0)])
    kernel = np.array([1, 2, 3, 4, 3, 2, 1], np.float32) / 16
    smooth = np.stack([np.convolve(around[:, k], kernel, "valid") for k in (0, 1)], 1)
    return np.concatenate([smooth[:-1:2], smooth[-1:]]).astype(np.float32)


def main() -> None:
    """Write what tells its object."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--leave-out", type=Path, nargs="*", default=[])
    given = parser.parse_args()
    cv2.setNumThreads(1)
    unseen = {first_word(name) for path in given.leave_out for name in names_in(path)}
    series: Counter[str] = Counter()
    arrays: dict[str, NDArray] = {}
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


def _write(out: Path, number: int, names: list[str], arrays: dict[str, NDArray]) -> None:
    temporary = out / f".clipart_{number:02d}.npz"
    np.savez(temporary, names=json.dumps(names), **arrays)
    temporary.replace(out / f"views_clipart_{number:02d}.npz")
    print(number, len(names), flush=True)


if __name__ == "__main__":
    main()
