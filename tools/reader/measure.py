"""Compares masks with and without the reader: IoU where a mask is known, a contact sheet of all, and time.

measure.py FOLDER… [--sheet OUT.png]

NAME_mask.png beside NAME.png is the truth; without one a drawing is on the sheet alone.
"""

import argparse
import time
from pathlib import Path

import cv2
import numpy as np

from normalgan.errors import InputError
from normalgan.inference.jobs.plan import OUTLINE
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import read_picture

SIDE = 190


def mask_of(path: Path, reader: bool) -> tuple[np.ndarray | None, float, str]:
    """Return the mask of a drawing, the seconds that it took, and what is said of it."""
    picture = read_picture(path)
    start = time.perf_counter()
    try:
        prepared = prepare(picture, 256, source=None if reader else OUTLINE)
    except InputError as error:
        return None, 0.0, str(error)
    mask = prepared.mask if prepared.mask is not None else np.zeros(prepared.ink.shape, bool)
    return mask, time.perf_counter() - start, prepared.unsure


def main() -> None:
    """Measure all folders."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--sheet", type=Path)
    given = parser.parse_args()
    cells, seconds = [], {False: [], True: []}
    for folder in given.folders:
        for path in sorted(folder.glob("*.png")):
            if path.stem.endswith("_mask"):
                continue
            try:
                picture = read_picture(path)
            except InputError as error:
                print(path.name, error)
                continue
            masks = {}
            for reader in (False, True):
                masks[reader], took, said = mask_of(path, reader)
                seconds[reader].append(took)
            truth = path.with_name(f"{path.stem}_mask.png")
            line = f"{path.stem:36}"
            for mask in masks.values():
                if mask is None:
                    line += f" {'refused':>8}"
                elif truth.is_file():
                    true = cv2.resize(cv2.imread(str(truth), 0), mask.shape[::-1]) > 127
                    line += f" {(true & mask).sum() / (true | mask).sum():8.3f}"
            if masks[False] is not None and masks[True] is not None:
                both = (masks[False] & masks[True]).sum() / max((masks[False] | masks[True]).sum(), 1)
                line += f"  same {both:.3f}"
            print(line, said)
            cells.append(
                _cell(
                    picture.colour
                    if picture.alpha is None
                    else picture.colour * picture.alpha[..., None] + 1 - picture.alpha[..., None],
                    masks,
                    path.stem,
                )
            )
    for reader, took in seconds.items():
        print("with reader:" if reader else "without:", f"{1000 * np.median(took):.0f} ms a drawing")
    if given.sheet and cells:
        while len(cells) % 4:
            cells.append(np.zeros_like(cells[0]))
        cv2.imwrite(
            str(given.sheet), np.vstack([np.hstack(cells[k : k + 4]) for k in range(0, len(cells), 4)])
        )


def _cell(colour: np.ndarray, masks: dict[bool, np.ndarray | None], name: str) -> np.ndarray:
    drawn = np.rint(255 * colour[..., ::-1]).astype(np.uint8)
    shown = [drawn]
    for mask in masks.values():
        tinted = cv2.resize(drawn, mask.shape[::-1]) if mask is not None else drawn
        if mask is not None:
            tinted = np.where(mask[..., None], 0.45 * tinted + np.array([40.0, 120, 20]), tinted).astype(
                np.uint8
            )
        shown.append(tinted)
    cell = np.full((SIDE + 14, 3 * (SIDE + 2), 3), 128, np.uint8)
    for k, each in enumerate(shown):
        share = SIDE / max(each.shape[:2])
        small = cv2.resize(each, None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
        cell[: small.shape[0], k * (SIDE + 2) : k * (SIDE + 2) + small.shape[1]] = small
    cv2.putText(cell, name[:40], (2, SIDE + 10), 0, 0.33, (255, 255, 255), 1)
    return cell


if __name__ == "__main__":
    main()
