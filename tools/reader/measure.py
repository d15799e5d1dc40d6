"""Measures how well objects are found: mask IoU by the lines alone and with the reader, holes, and time.

measure.py [FOLDER…] [--pages VIEWS] [--holes] [--sheet OUT.png]

A drawing NAME.png of a FOLDER is compared with NAME_mask.png, if that is there: as it is, and grown by 3
pixels, as masks drawn by hand lie a little outside of the lines. --pages makes pages of meshes
that the reader was not trained on, eight of each kind, and takes such clip art as it was drawn and by its
lines alone. --holes draws eight things with holes through them, and 128 plain shapes without any.
"""

import argparse
import time
from itertools import product
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from pages import KINDS, page
from pierced import drawings
from shapes import Shape, Views, darkness

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.mask.masks import OUTLINE
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture, read_picture

SIDE = 190
SOURCES = {"lines": OUTLINE, "reader": None}
"""What decides on the object, by the name in the tables."""
PAGES, PAGE = 8, (400, 400)
GROWN = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))


class Measured:
    """Masks by each source, and how long they took."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {name: [] for name in SOURCES}

    def masks(self, picture: Picture) -> dict[str, NDArray[np.bool_] | None]:
        """Return the mask (H, W) by each source, None where the drawing is refused."""
        found: dict[str, NDArray[np.bool_] | None] = {}
        for name, source in SOURCES.items():
            start = time.perf_counter()
            try:
                prepared = prepare(picture, 256, mask=source)
            except InputError:
                found[name] = None
                continue
            self.seconds[name].append(time.perf_counter() - start)
            empty = np.zeros(prepared.ink.shape, bool)
            found[name] = empty if prepared.mask is None else prepared.mask
        return found

    def say(self) -> None:
        """Print the time of a drawing."""
        for name, took in self.seconds.items():
            if took:
                print(f"{name}: {1000 * np.median(took):.0f} ms a drawing (median of {len(took)})")


def iou(mask: NDArray[np.bool_] | None, truth: NDArray[np.bool_]) -> float:
    """Return the intersection over union; 0 for a drawing that was refused."""
    if mask is None:
        return 0.0
    return int((mask & truth).sum()) / max(int((mask | truth).sum()), 1)


def measure_pages(views: Path, measured: Measured) -> None:
    """Print the mean IoU on rendered pages by kind."""
    shapes = Views(views, held_out=True).shapes
    measure_clipart([shape for shape in shapes if shape.paint is not None], measured)
    shapes = [shape for shape in shapes if shape.paint is None]
    means = []
    for kind in KINDS:
        rng, scores = np.random.default_rng(11), []
        for _ in range(PAGES):
            made = page(rng, shapes, PAGE, kind)
            colour = np.ascontiguousarray(made.picture[..., ::-1]).astype(np.float32) / np.float32(255)
            masks = measured.masks(Picture(colour, None))
            scores.append([iou(mask, made.presence > 0.5) for mask in masks.values()])
        means.append(np.mean(scores, 0))
        _say_row(kind, means[-1])
    _say_row("mean", np.mean(means, 0))


def measure_clipart(shapes: list[Shape], measured: Measured) -> None:
    """Print the mean and the worst tenth of the IoU on clip art, in colours and by its lines."""
    scores: dict[str, list[list[float]]] = {"clip art": [], "its lines": []}
    for shape in shapes:
        drawn = shape.drawn()
        opacity = drawn[..., 3:].astype(np.float32) / np.float32(255)
        colour: Floats = drawn[..., 2::-1] / np.float32(255) * opacity + 1 - opacity
        shown = {"clip art": colour}
        if shape.lined:
            shown["its lines"] = np.repeat(1 - darkness(255 * colour)[..., None], 3, 2)
        for name, picture in shown.items():
            masks = measured.masks(Picture(np.ascontiguousarray(picture), None))
            scores[name].append([iou(mask, _sized(opacity, mask)) for mask in masks.values()])
    for name, found in scores.items():
        if found:
            _say_row(f"{name} ({len(found)})", np.mean(found, 0))
            _say_row("  worst tenth", np.quantile(found, 0.1, axis=0))


def _sized(opacity: NDArray[np.float32], mask: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    size = (1, 1) if mask is None else mask.shape[::-1]
    return cv2.resize(opacity, size, interpolation=cv2.INTER_AREA) > 0.5


def _say_row(kind: str, scores: NDArray[np.float64]) -> None:
    print(f"{kind:16}", *(f"{name} {score:.3f}" for name, score in zip(SOURCES, scores, strict=True)))


def measure_holes(measured: Measured) -> None:
    """Print which drawings have all their holes, and nothing else as a hole."""
    right = dict.fromkeys(SOURCES, 0)
    for name, drawn in drawings().items():
        colour = np.repeat(drawn.page[..., None], 3, -1)
        for source, mask in measured.masks(Picture(colour, None)).items():
            good = mask is not None and not any(mask[y, x] for x, y in drawn.holes)
            good = good and mask is not None and all(mask[y, x] for x, y in drawn.solid)
            right[source] += good
            print(f"{name:16} {source} {'right' if good else 'wrong'}")
    print("right:", " ".join(f"{name} {count} of {len(drawings())}" for name, count in right.items()))


def measure_plain(measured: Measured) -> None:
    """Print how many triangles, squares, pentagons and discs are not solid: taken for frames and rings."""
    wrong, count = dict.fromkeys(SOURCES, 0), 0
    for corners, radius, width, turn in product((3, 4, 5, 40), (40, 60, 80, 105), (1, 2, 4, 7), (0, 0.4)):
        paper, solid = np.ones((256, 256), np.float32), np.zeros((256, 256), np.uint8)
        around = np.linspace(0, 2 * np.pi, corners, endpoint=False) + turn
        points = np.rint(128 + radius * np.stack([np.cos(around), np.sin(around)], 1)).astype(np.int32)
        cv2.polylines(paper, [points], True, (0,), width)
        cv2.fillPoly(solid, [points], (1,))
        cv2.polylines(solid, [points], True, (1,), width)
        colour = np.repeat(paper[..., None], 3, 2)
        for source, mask in measured.masks(Picture(colour, None)).items():
            wrong[source] += iou(mask, solid > 0) < 0.9
        count += 1
    print("plain shapes wrong:", " ".join(f"{name} {number} of {count}" for name, number in wrong.items()))


def measure_folder(folder: Path, measured: Measured) -> list[NDArray[np.uint8]]:
    """Print the IoU of each drawing, and return a cell of each for a contact sheet."""
    cells = []
    for path in sorted(folder.glob("*.png")):
        if path.stem.endswith("_mask"):
            continue
        try:
            picture = read_picture(path)
        except InputError as error:
            print(path.name, error)
            continue
        masks = measured.masks(picture)
        truth = path.with_name(f"{path.stem}_mask.png")
        line = f"{path.stem:36}"
        for name, mask in masks.items():
            line += f" {name} " + ("refused" if mask is None else "")
            if mask is not None and truth.is_file():
                painted = np.asarray(cv2.imread(str(truth), 0))
                by_hand = cv2.resize(painted, mask.shape[::-1]) > 127
                grown = cv2.dilate(mask.astype(np.uint8), GROWN) > 0
                line += f"{iou(mask, by_hand):.3f}, grown {iou(grown, by_hand):.3f}"
        by_lines, by_reader = masks.values()
        if by_lines is not None and by_reader is not None:
            line += f"  alike {iou(by_lines, by_reader):.3f}"
        print(line)
        cells.append(_cell(picture, masks, path.stem))
    return cells


def _cell(picture: Picture, masks: dict[str, NDArray[np.bool_] | None], name: str) -> NDArray[np.uint8]:
    alpha = np.ones(picture.size, np.float32) if picture.alpha is None else picture.alpha
    colour = picture.colour * alpha[..., None] + 1 - alpha[..., None]
    drawn = np.rint(255 * colour[..., ::-1]).astype(np.uint8)
    shown = [drawn]
    for mask in masks.values():
        if mask is None:
            shown.append(drawn)
            continue
        below = cv2.resize(drawn, mask.shape[::-1])
        tinted = 0.45 * below + np.array([40.0, 120, 20])
        shown.append(np.where(mask[..., None], tinted, below).astype(np.uint8))
    cell = np.full((SIDE + 14, 3 * (SIDE + 2), 3), 128, np.uint8)
    for k, each in enumerate(shown):
        share = SIDE / max(each.shape[:2])
        small = cv2.resize(each, None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
        cell[: small.shape[0], k * (SIDE + 2) : k * (SIDE + 2) + small.shape[1]] = small
    cv2.putText(cell, name[:40], (2, SIDE + 10), 0, 0.33, (255, 255, 255), 1)
    return cell


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument(
        "--pages", type=Path, metavar="VIEWS", help="where views.py has written views of meshes"
    )
    parser.add_argument("--holes", action="store_true")
    parser.add_argument("--sheet", type=Path)
    given = parser.parse_args()
    cv2.setNumThreads(1)
    measured = Measured()
    if given.pages:
        measure_pages(given.pages, measured)
    if given.holes:
        measure_holes(measured)
        measure_plain(measured)
    cells = [cell for folder in given.folders for cell in measure_folder(folder, measured)]
    measured.say()
    if given.sheet and cells:
        while len(cells) % 4:
            cells.append(np.zeros_like(cells[0]))
        rows = [np.hstack(cells[k : k + 4]) for k in range(0, len(cells), 4)]
        cv2.imwrite(str(given.sheet), np.vstack(rows))


if __name__ == "__main__":
    main()
