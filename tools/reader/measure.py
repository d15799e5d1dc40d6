"""Measures how well objects are found: mask IoU from the lines alone and with the reader, holes, and time.

measure.py [FOLDER…] [--pages VIEWS] [--holes] [--doodles] [--sheet OUT.png]

The mask of a drawing NAME.png in a FOLDER is compared with NAME_mask.png, if it exists. It is also compared
when grown by 3 pixels, because masks drawn by hand lie a little outside the lines. --pages takes meshes and
clip art that the reader was not trained on. It makes eight pages of each kind and eight crops of each size
from the meshes, takes the clip art in its colours and as lines alone, and counts how often opaque objects and
opaque lines are told apart.
--holes draws twenty things, eight of them pierced, 128 plain shapes without holes, and 64 cards with a
figure. --doodles draws doodles.svg, straight and by hand.
"""

import argparse
import time
from itertools import product
from pathlib import Path

import cv2
import numpy as np
from crops import SIZES, crop
from doodles import HANDS, doodles
from grounds import plane
from numpy.typing import NDArray
from pages import KINDS, Page, page
from shapes import Shape, Views, darkness
from things import drawings

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.silhouette import is_silhouette
from normalgan.inference.mask.mask_files import OUTLINE
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture, read_picture

SIDE = 190
SOURCES = {"lines": OUTLINE, "reader": None}
"""The ways to find the object, by name in the tables."""
PAGES, PAGE = 8, (400, 400)
MARGINS = 0.02, 0.05, 0.1, 0.2
"""Margins between a card and the edge, as shares of the side."""
ROUND = 60
"""Number of corners of the polygon that stands for a disc."""
RIGHT = 0.95
"""IoU from which a doodle counts as right."""
GROWN = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))


class Measured:
    """Finds masks with each source, and records the times."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {name: [] for name in SOURCES}

    def masks(self, picture: Picture) -> dict[str, NDArray[np.bool_] | None]:
        """Return the mask (H, W) from each source, or None if it refuses the drawing."""
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
        """Print the median time per drawing."""
        for name, took in self.seconds.items():
            if took:
                print(f"{name}: {1000 * np.median(took):.0f} ms a drawing (median of {len(took)})")


def iou(mask: NDArray[np.bool_] | None, truth: NDArray[np.bool_]) -> float:
    """Return the intersection over union, or 0 for a refused drawing."""
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
        rng = np.random.default_rng(11)
        made = [page(rng, shapes, PAGE, kind) for _ in range(PAGES)]
        means.append(np.mean([_scores(each, measured) for each in made], 0))
        _say_row(kind, means[-1])
    _say_row("mean", np.mean(means, 0))
    means = []
    for height, width in dict.fromkeys(size for size, _ in SIZES):
        rng = np.random.default_rng(12)
        crops = [crop(rng, shapes, (height, width)) for _ in range(PAGES)]
        means.append(np.mean([_scores(each, measured) for each in crops], 0))
        _say_row(f"crop {width} x {height}", means[-1])
    _say_row("mean of crops", np.mean(means, 0))
    measure_opacity(shapes)


def _scores(made: Page, measured: Measured) -> list[float]:
    """Return the IoU on a page with each source."""
    colour = np.ascontiguousarray(made.picture[..., ::-1]).astype(np.float32) / np.float32(255)
    return [iou(mask, made.presence > 0.5) for mask in measured.masks(Picture(colour, None)).values()]


def measure_opacity(shapes: list[Shape], count: int = 40, side: int = 400) -> None:
    """Print how often opaque objects, opaque lines, and cards around lines are recognised as such."""
    rng = np.random.default_rng(71)
    right: dict[str, list[bool]] = {}
    for number in rng.permutation(len(shapes))[:count]:
        shape = shapes[number]
        body = np.max([plane(group, side, None) for group in shape.contours], axis=0)[..., 0]
        ink, pen = (plane(shape.strokes, side, width)[..., 0] for width in (3, int(rng.integers(1, 9))))
        outlined, dark = np.maximum(body, ink), rng.uniform(0, 0.35, 3)
        lower = body.copy()
        lower[: int(np.quantile(np.nonzero(body > 0.5)[0], rng.uniform(0.3, 0.7)))] = 0
        depth = cv2.distanceTransform((body > 0.5).astype(np.uint8), cv2.DIST_L2, 5)
        y, x = np.unravel_index(int(depth.argmax()), depth.shape)
        opened = body.copy()
        cv2.circle(opened, (int(x), int(y)), round(0.6 * float(depth.max())), (0,), -1)
        room, half = rng.integers(0, side // 8), rng.integers(side // 8, side // 2, 2)
        card, box = np.zeros((2, side, side), np.float32)
        card[room : side - room, room : side - room] = 1
        box[side // 2 - half[0] : side // 2 + half[0], side // 2 - half[1] : side // 2 + half[1]] = 1
        for kind, paint, alpha, is_object in (
            ("flat black", 0.0, body, True),
            ("flat dark", dark, body, True),
            ("flat", rng.uniform(0.2, 0.8, 3), body, True),
            ("outlined, dark", dark * (1 - ink[..., None]), outlined, True),
            ("black, pierced", 0.0, opened, True),
            ("lines", rng.choice([0.0, 0.5]), pen, False),
            ("half black", 0.0, np.maximum(lower, ink), False),
            ("box", rng.uniform(0, 1, 3), box, True),
            ("card", rng.uniform(0.8, 1, 3) * (1 - ink[..., None]), card, False),
        ):
            colour = np.ascontiguousarray(np.broadcast_to(np.float32(paint), (side, side, 3)))
            found = is_silhouette(Picture(colour, alpha, cut_out=True))
            right.setdefault(kind, []).append(found == is_object)
    for kind, each in right.items():
        print(f"opacity: {kind:16} right {np.mean(each):.3f} of {len(each)}")


def measure_clipart(shapes: list[Shape], measured: Measured) -> None:
    """Print the mean and the worst tenth of the IoU on clip art, in colour and as lines."""
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
    """Print which drawings are found with all their holes and no other holes."""
    right = dict.fromkeys(SOURCES, 0)
    for name, drawn in drawings().items():
        colour = np.repeat(drawn.page[..., None], 3, -1)
        for source, mask in measured.masks(Picture(colour, None)).items():
            good = mask is not None and not any(mask[y, x] for x, y in drawn.holes)
            good = good and mask is not None and all(mask[y, x] for x, y in drawn.solid)
            right[source] += good
            print(f"{name:16} {source} {'right' if good else 'wrong'}")
    print("right:", " ".join(f"{name} {count} of {len(drawings())}" for name, count in right.items()))


def measure_doodles(measured: Measured) -> None:
    """Print the IoU of doodles that any source gets wrong, the mean, and the number of right ones."""
    scores: list[list[float]] = []
    for hand in HANDS:
        for name, drawn, there in doodles(hand):
            masks = measured.masks(Picture(np.repeat(drawn[..., None], 3, -1), None))
            scores.append([iou(mask, _sized(there.astype(np.float32), mask)) for mask in masks.values()])
            if min(scores[-1]) < RIGHT:
                _say_row(f"{name}, {hand}", np.array(scores[-1]))
    _say_row(f"doodles ({len(scores)})", np.mean(scores, 0))
    right = (np.array(scores) >= RIGHT).sum(0)
    print(f"{RIGHT} or more:", *(f"{name} {n}" for name, n in zip(SOURCES, right, strict=True)))


def measure_plain(measured: Measured) -> None:
    """Print how many triangles, squares, pentagons and discs are mistaken for frames and rings."""
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


def measure_cards(measured: Measured) -> None:
    """Print how many cards are mistaken for frames, or have a figure that is mistaken for a hole."""
    side, wrong, count = 400, dict.fromkeys(SOURCES, 0), 0
    sheets, figures = ((4, 1.0), (4, 0.75), (ROUND, 1.0)), ((ROUND, 1.0), (4, 1.0), (10, 0.45))
    for (corners, flat), (points, inner), away, width in product(sheets, figures, MARGINS, (1, 4)):
        if corners == points == ROUND:  # this may be a ring
            continue
        paper, solid = np.ones((side, side), np.float32), np.zeros((side, side), np.uint8)
        reach = (0.5 - away) * side
        card = _figure(side / 2, reach * (2**0.5 if corners == 4 else 1), corners, np.pi / corners, 1.0)
        card[:, 1] = side / 2 + (card[:, 1] - side / 2) * flat
        figure = _figure(0.53 * side, 0.4 * flat * reach, points, -np.pi / 2, inner)
        cv2.polylines(paper, [card, figure], True, (0,), width)
        cv2.fillPoly(solid, [card], (1,))
        cv2.polylines(solid, [card], True, (1,), width)
        for source, mask in measured.masks(Picture(np.repeat(paper[..., None], 3, 2), None)).items():
            wrong[source] += iou(mask, solid > 0) < 0.9
        count += 1
    print("cards wrong:", " ".join(f"{name} {number} of {count}" for name, number in wrong.items()))


def _figure(middle: float, radius: float, points: int, turn: float, inner: float) -> NDArray[np.int32]:
    """Return a polygon (P, 2); ``inner`` below 1 makes it a star."""
    around = np.linspace(0, 2 * np.pi, points, endpoint=False) + turn
    away = radius * np.where(np.arange(points) % 2, inner, 1)
    path = middle + away[:, None] * np.stack([np.cos(around), np.sin(around)], 1)
    return np.asarray(np.rint(path), np.int32)


def measure_folder(folder: Path, measured: Measured) -> list[NDArray[np.uint8]]:
    """Print the IoU of each drawing, and return its cells for a contact sheet."""
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
    """Run the measurements that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument(
        "--pages", type=Path, metavar="VIEWS", help="where views.py has written views of meshes"
    )
    parser.add_argument("--holes", action="store_true")
    parser.add_argument("--doodles", action="store_true")
    parser.add_argument("--sheet", type=Path)
    given = parser.parse_args()
    cv2.setNumThreads(1)
    measured = Measured()
    if given.pages:
        measure_pages(given.pages, measured)
    if given.holes:
        measure_holes(measured)
        measure_plain(measured)
        measure_cards(measured)
    if given.doodles:
        measure_doodles(measured)
    cells = [cell for folder in given.folders for cell in measure_folder(folder, measured)]
    measured.say()
    if given.sheet and cells:
        while len(cells) % 4:
            cells.append(np.zeros_like(cells[0]))
        rows = [np.hstack(cells[k : k + 4]) for k in range(0, len(cells), 4)]
        cv2.imwrite(str(given.sheet), np.vstack(rows))


if __name__ == "__main__":
    main()
