"""Figures of a page: separate objects, and parts of one; on readings made by hand."""

import cv2
import numpy as np

from normalgan.inference.cleaning.reader import Reading
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.figures import find_figures
from normalgan.inference.mask.decision import decide

SIDE = 256
Circle = tuple[int, int, int]


def figures(circles: list[Circle], *, one: bool = False, line: bool = False) -> list[Cell]:
    """Return the figures of a page of circles.

    Args:
        circles: x, y and radius of each.
        one: whether the reader sees the middle of all of them in each, and not its own.
        line: whether a line connects all.
    """
    ink, presence = np.zeros((SIDE, SIDE), np.float32), np.full((SIDE, SIDE), 0.02, np.float32)
    middle = np.zeros((2, SIDE, SIDE), np.float32)
    for x, y, radius in circles:
        cv2.circle(ink, (x, y), radius, 1, 2)
        inside = np.zeros((SIDE, SIDE), np.uint8)
        cv2.circle(inside, (x, y), radius, 1, -1)
        presence[inside > 0] = 0.95
        seen = np.mean(circles, axis=0)[:2] if one else np.array([x, y])
        middle[:, inside > 0] = seen[:, None] / SIDE
    if line:
        cv2.line(ink, circles[0][:2], circles[-1][:2], 1, 2)
    reading = Reading(ink, presence, middle)
    return find_figures(decide(ink, reading), reading, (2 * SIDE, 2 * SIDE))


def test_separate_circles_are_figures_in_reading_order_and_in_pixels_of_the_drawing() -> None:
    found = figures([(190, 60, 30), (60, 70, 40), (120, 190, 35)])
    assert [each.name for each in found] == ["figure 1", "figure 2", "figure 3"]
    assert [abs(each.left + each.width / 2 - x) < 12 for each, x in zip(found, (120, 380, 240), strict=True)]
    for each, (x, y, radius) in zip(found, [(60, 70, 40), (190, 60, 30), (120, 190, 35)], strict=True):
        assert each.left < 2 * (x - radius)
        assert each.left + each.width > 2 * (x + radius)
        assert each.own is not None
        assert each.own[2 * y - each.top, 2 * x - each.left]


def test_boxes_that_overlap_keep_what_is_their_own() -> None:
    found = figures([(80, 80, 60), (175, 175, 60)])
    assert len(found) == 2
    whole = np.zeros((2 * SIDE, 2 * SIDE), int)
    for each in found:
        whole[each.box] += each.own
    assert whole.max() == 1


def test_parts_whose_middle_lies_between_them_are_one_object() -> None:
    assert figures([(60, 128, 35), (190, 128, 35)], one=True) == []


def test_what_a_line_connects_is_one_object() -> None:
    assert figures([(60, 128, 35), (190, 128, 35)], line=True) == []


def test_a_small_part_is_no_figure() -> None:
    assert figures([(100, 128, 80), (220, 60, 10)]) == []
