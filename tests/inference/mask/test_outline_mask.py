import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.mask.decision import decide
from pens import blob, outline, overlap

FILLED = blob()
INK = outline(FILLED)


def drawn(*strokes: list[tuple[int, int]], size: int = 200, width: int = 2) -> Floats:
    """Return open strokes through points, as ink."""
    ink = np.zeros((size, size), np.float32)
    for points in strokes:
        cv2.polylines(ink, [np.array(points, np.int32)], False, 1, width)
    return ink


def test_a_gap_in_the_outline_is_closed() -> None:
    gap = INK.copy()
    gap[140:, 165:168] = 0
    closed = decide(gap, None)
    assert closed.closed > 0.9
    assert not closed.guessed
    assert overlap(closed.mask, decide(INK, None).mask) > 0.97


def test_a_wide_gap_is_closed_if_most_of_the_outline_is_open_and_told() -> None:
    gap = INK.copy()
    gap[120:, 154:170] = 0  # a ninth of what it spans
    closed = decide(gap, None)
    assert closed.closed > 0.9
    assert closed.guessed
    assert overlap(closed.mask, decide(INK, None).mask) > 0.95


def test_lines_that_enclose_nothing_are_told() -> None:
    parallel = decide(drawn([(20, 50), (180, 50)], [(20, 90), (100, 90), (180, 150)]), None)
    assert parallel.guessed or parallel.closed < 0.5
    single = decide(drawn([(20, 50), (180, 60)]), None)
    assert not single.mask.any()
    assert single.closed == 0
    assert not single.guessed


def test_what_shot_beyond_its_goal_does_not_belong_to_the_object() -> None:
    ink = INK.copy()
    cv2.line(ink, (228, 90), (242, 88), 1, 2)
    mask = decide(ink, None).mask
    assert not mask[70:100, 236:].any()
    assert overlap(mask, decide(INK, None).mask) > 0.98


def test_legs_are_not_grown_together() -> None:
    ink = np.zeros((200, 200), np.float32)
    x = [20, 180, 180, 160, 160, 40, 40, 20]
    y = [30, 30, 180, 180, 90, 90, 180, 180]
    cv2.polylines(ink, [np.stack([x, y], axis=1).astype(np.int32)], True, 1, 2)
    mask = decide(ink, None).mask
    assert mask[60, 100]
    assert mask[150, 30]
    assert not mask[130, 100]
