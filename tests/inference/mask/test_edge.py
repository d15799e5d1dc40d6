"""The object's edge against outlines whose place is known to a part of a pixel."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from skimage.morphology import reconstruction

from normalgan.arrays import Floats
from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.mask.decision import decide
from normalgan.inference.mask.mask_files import OUTLINE
from normalgan.inference.network.upsampling import enlarge
from normalgan.inference.pipeline import finish
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture

Points = NDArray[np.float64]


def closed_curve(shape: str) -> Points:
    """Return the corners (K, 2) of an outline in shares of the picture's side."""
    angle = np.linspace(0, 2 * np.pi, 180, endpoint=False)
    match shape:
        case "circle":
            radius = np.full_like(angle, 0.36)
        case "flower":
            radius = 0.3 + 0.07 * np.cos(5 * angle)
        case "slanted square":
            turned = (angle + 0.3) % (np.pi / 2) - np.pi / 4
            radius = 0.25 / np.cos(turned)
    return np.stack([0.5 + radius * np.cos(angle), 0.5 + radius * np.sin(angle)], 1)


def drawn(points: Points, size: int, width: float, *, closed: bool = True) -> Floats:
    """Return a line through points, in pixels, as ink (size, size); its edges are a pixel wide."""
    band = np.zeros((size, size), np.uint8)
    cv2.polylines(band, [np.rint(points - 0.5).astype(np.int32)], closed, 1, round(width) + 6)
    rows, columns = np.nonzero(band)
    middles = np.stack([columns, rows], 1).astype(np.float64) + 0.5
    away = distances(middles, points, closed=closed)
    ink = np.zeros((size, size), np.float32)
    ink[rows, columns] = np.clip(width / 2 + 0.5 - away, 0, 1)
    return ink


def edge_points(covered: Floats) -> Points:
    """Return where coverage crosses a half along rows and columns, (N, 2), x and y in pixels."""
    found = []
    for axis in (0, 1):
        values = covered if axis else covered.T
        row, column = np.nonzero((values[:, :-1] > 0.5) != (values[:, 1:] > 0.5))
        one, other = values[row, column], values[row, column + 1]
        at = column + 0.5 + (0.5 - one) / (other - one)
        pair = [at, row + 0.5] if axis else [row + 0.5, at]
        found.append(np.stack(pair, 1))
    return np.concatenate(found).astype(np.float64)


def distances(points: Points, corners: Points, *, closed: bool = True) -> NDArray[np.float64]:
    """Return how far points are from an outline."""
    start, way = corners, np.roll(corners, -1, 0) - corners
    if not closed:
        start, way = start[:-1], way[:-1]
    found = []
    for part in np.array_split(points, max(len(points) // 2000, 1)):
        along = ((part[:, None] - start) * way).sum(-1) / (way**2).sum(-1)
        foot = start + np.clip(along, 0, 1)[..., None] * way
        found.append(np.hypot(*np.moveaxis(part[:, None] - foot, -1, 0)).min(1))
    return np.concatenate(found)


@pytest.mark.parametrize("size", [512, 1024])
@pytest.mark.parametrize("shape", ["circle", "flower", "slanted square"])
def test_the_edge_is_the_outer_edge_of_the_ink(shape: str, size: int) -> None:
    corners, width = closed_curve(shape) * size, size / 170
    outline = decide(drawn(corners, size, width), None)
    found = edge_points(outline.coverage)
    found = found[:: max(len(found) // 1000, 1)]
    # From the line's middle to its outer edge it is half the line's width.
    off = np.abs(distances(found, corners) - width / 2)
    assert off.max() <= 0.5
    assert off.mean() <= 0.1
    assert np.array_equal(outline.mask, outline.coverage > 0.5)


@pytest.mark.parametrize("shape", ["circle", "flower", "slanted square"])
@pytest.mark.parametrize("width", [2.0, 3.0, 4.5])
def test_nothing_inside_a_thin_outline_is_transparent(shape: str, width: float) -> None:
    ink = drawn(closed_curve(shape) * 256, 256, width)
    covered = decide(ink, None).coverage
    deepest = covered.copy()
    deepest[1:-1, 1:-1] = 1
    filled = reconstruction(deepest, covered, method="erosion")
    assert np.abs(filled - covered).max() < 0.05


@pytest.mark.slow  # the largest map has 16 million pixels
@pytest.mark.parametrize(
    ("size", "drawn_here", "off"),
    [(512, False, 0.5), (2048, True, 0.5), (2048, False, 0.5), (4096, True, 0.5), (4096, False, 0.8)],
)
def test_the_opacity_of_a_map_ends_where_the_ink_ends(size: int, drawn_here: bool, off: float) -> None:
    corners, width = closed_curve("flower") * size, size / 170
    paper = np.repeat(1 - drawn(corners, size, width)[..., None], 3, -1)
    prepared = prepare(Picture(paper, None), 64, mask=OUTLINE, clean_strokes=drawn_here)
    facing = np.zeros((64, 64, 3), np.float32)
    facing[..., 2] = 1
    found = edge_points(finish(prepared, facing, None, enlarge).alpha)
    found = found[:: max(len(found) // 1000, 1)]
    assert np.abs(distances(found, corners) - width / 2).max() <= off


@pytest.mark.parametrize("size", [512, 1024])
def test_the_edge_of_an_open_outline_stays_on_its_ink(size: int) -> None:
    corners, width = closed_curve("circle") * size, size / 170
    gap = 5  # of 180 corners: 0.07 of the side
    ink = drawn(np.roll(corners, -5, 0)[: len(corners) - gap], size, width, closed=False)
    radius = round(np.hypot(*(corners[0] - size / 2)) * 256 / size)
    disc = np.zeros((256, 256), np.float32)
    cv2.circle(disc, (128, 128), radius, 1, -1)
    found = edge_points(decide(ink, Reading(disc, disc, np.zeros((2, 256, 256), np.float32))).coverage)
    angle = np.abs(np.angle((found[:, 0] - size / 2) + 1j * (found[:, 1] - size / 2)))
    along = found[angle > 0.4]
    assert np.abs(distances(along, corners) - width / 2).max() <= 0.5


def test_a_narrow_slit_stays_open_and_lines_beside_the_object_do_not_join_it() -> None:
    size = 1024
    corners = np.array(
        [[300, 200], [700, 200], [700, 800], [520, 800], [506, 330], [492, 800], [300, 800]], float
    )
    ink = drawn(corners, size, 4)
    mask = decide(ink, None).mask
    assert not mask[700:780, 505:508].any()
    assert mask[700, 400]
    assert mask[700, 600]
    beside = np.maximum(ink, drawn(corners[:1] - [9, 9] + [[0, 0], [0, 50]], size, 2, closed=False))
    assert not decide(beside, None).mask[195:240, 285:293].any()


@pytest.mark.parametrize("size", [512, 1024])
def test_the_ink_of_thin_tips_is_object(size: int) -> None:
    # A stool on legs that taper to a point: their lines meet long before they end.
    legs = [
        (0.2, 0.4),
        (0.24, 0.9),
        (0.28, 0.4),
        (0.46, 0.4),
        (0.5, 0.92),
        (0.54, 0.4),
        (0.72, 0.4),
        (0.76, 0.9),
        (0.8, 0.4),
    ]
    corners = np.array([(0.8, 0.3), (0.2, 0.3), *legs]) * size
    ink = drawn(corners, size, size / 128)
    covered = decide(ink, None).coverage
    outside = (ink > 0.5) & (covered <= 0.5)
    assert np.count_nonzero(outside) <= 0.001 * np.count_nonzero(ink > 0.5)
    # And nothing between the legs.
    assert not (covered[int(0.6 * size), int(0.36 * size) : int(0.4 * size)] > 0).any()
