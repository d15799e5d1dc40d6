"""Tests of how wide lines are, and how they are shown to the model."""

import cv2
import numpy as np
import pytest

from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import line_width, render_model_input
from normalgan.line_widths import USUAL_WIDTHS


@pytest.mark.parametrize("width", [1, 2, 5, 8])
def test_the_width_of_lines_does_not_depend_on_the_paper_about_them(width: int) -> None:
    inked = np.zeros((60, 90), np.bool_)
    inked[20 : 20 + width] = inked[:, 40 : 40 + width] = True  # up to the edges of the picture
    tight = line_width(inked)
    assert abs(tight - width) <= 1
    inside = np.zeros((120, 150), np.bool_)
    inside[30:90, 30:120] = inked
    assert line_width(inside) == pytest.approx(tight, abs=0.5)
    assert line_width(np.pad(inside, ((50, 3), (0, 70)))) == line_width(inside)


def test_without_ink_there_is_no_width() -> None:
    assert line_width(np.zeros((8, 8), np.bool_)) == 0


def test_lines_that_are_thin_beside_the_others_are_shown() -> None:
    outline, thin = np.zeros((2, 256, 256), np.uint8)
    cv2.circle(outline, (128, 128), 95, 255, 6, cv2.LINE_AA)
    cv2.ellipse(thin, (95, 110), (14, 20), 0, 0, 360, 255, 1, cv2.LINE_AA)
    cv2.line(thin, (128, 150), (128, 222), 255, 1, cv2.LINE_AA)  # it ends in the outline
    drawn, within, around = (
        (each / 255).astype(np.float32) for each in (np.maximum(outline, thin), thin, outline)
    )
    frame = Frame.around(drawn, 256)
    shown = render_model_input(drawn, frame, USUAL_WIDTHS)
    where = frame.cut(within) > 0.5
    where &= cv2.dilate(frame.cut(around), np.ones((3, 3), np.uint8)) < 0.1
    assert where.sum() > 100
    near = cv2.dilate(shown, np.ones((3, 3), np.uint8)) > 0.5
    assert near[where].mean() > 0.98


def test_a_black_shape_is_shown_as_its_outline_alone() -> None:
    disc = np.zeros((256, 256), np.uint8)
    cv2.circle(disc, (128, 128), 90, 255, -1, cv2.LINE_AA)
    drawn = (disc / 255).astype(np.float32)
    frame = Frame.around(drawn, 256)
    shown = render_model_input(drawn, frame, USUAL_WIDTHS)
    black = (frame.cut(drawn) > 0.5).astype(np.uint8)
    square = np.ones((3, 3), np.uint8)
    edge = black > cv2.erode(black, square)
    near = cv2.dilate(edge.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    assert shown[~near].max() < 0.1
    assert cv2.dilate(shown, square)[edge].min() > 0.3


@pytest.mark.parametrize("radius", [6, 8, 10])
def test_the_lines_of_a_tiny_figure_are_lines_and_not_areas(radius: int) -> None:
    y, x = np.mgrid[:230, :230] - 110.5
    drawn = np.clip(1.5 - np.abs(np.hypot(x, y) - radius), 0, 1).astype(np.float32)  # two pixels wide
    shown = render_model_input(drawn, Frame.around(drawn, 256), USUAL_WIDTHS)
    lines, _ = cv2.connectedComponents((shown > 0.3).astype(np.uint8), connectivity=8)
    assert lines == 1 + 1  # the paper, and one line instead of an inner and an outer edge
