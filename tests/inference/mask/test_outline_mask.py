import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.inference.mask.bridging import bridges
from normalgan.inference.mask.outline_mask import fill_outline
from normalgan.inference.mask.stroke_ends import stroke_ends
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
    gap[140:, 165:171] = 0
    closed = fill_outline(gap)
    assert closed.closed > 0.9
    assert not closed.guessed
    assert overlap(closed.mask, fill_outline(INK).mask) > 0.97


@pytest.mark.parametrize("width", [2.0, 3.0, 6.0])
def test_a_wide_gap_is_closed_straight_from_end_to_end(width: float) -> None:
    gap = outline(FILLED, width)
    gap[120:, 154:178] = 0  # a sixth of what it spans
    closed = fill_outline(gap)
    assert closed.closed > 0.9
    assert not closed.guessed
    assert overlap(closed.mask, fill_outline(outline(FILLED, width)).mask) > 0.97


def test_a_half_that_is_missing_is_closed_straight_and_told() -> None:
    half = INK.copy()
    half[:, 170:] = 0
    closed = fill_outline(half)
    assert closed.guessed
    truth = np.maximum(FILLED, INK)
    truth[:, 170:] = 0
    assert overlap(closed.mask, truth) > 0.94


def test_lines_that_enclose_nothing_are_told() -> None:
    parallel = fill_outline(drawn([(20, 50), (180, 50)], [(20, 90), (100, 90), (180, 150)]))
    assert parallel.guessed or parallel.closed < 0.5
    single = fill_outline(drawn([(20, 50), (180, 60)]))
    assert not single.mask.any()
    assert single.closed == 0
    assert not single.guessed


def test_what_shot_beyond_its_goal_does_not_belong_to_the_object() -> None:
    ink = INK.copy()
    cv2.line(ink, (228, 90), (242, 88), 1, 2)
    mask = fill_outline(ink).mask
    assert not mask[70:100, 236:].any()
    assert overlap(mask, fill_outline(INK).mask) > 0.98


def test_legs_of_a_single_line_are_as_wide_as_it() -> None:
    ink = INK.copy()
    for x in (140, 200):
        cv2.line(ink, (x, 140), (x, 195), 1, 2)
    mask = fill_outline(ink).mask
    assert mask[155:190, 140].all()
    assert mask[155:190, 200].all()
    assert not mask[160:195, 150:190].any()
    assert mask[180].sum() <= 12
    away = INK.copy()
    cv2.line(away, (20, 20), (20, 100), 1, 2)  # a line that is not at the object
    assert not fill_outline(away).mask[:, :40].any()


def test_legs_are_not_grown_together() -> None:
    ink = np.zeros((200, 200), np.float32)
    x = [20, 180, 180, 160, 160, 40, 40, 20]
    y = [30, 30, 180, 180, 90, 90, 180, 180]
    cv2.polylines(ink, [np.stack([x, y], axis=1).astype(np.int32)], True, 1, 2)
    mask = fill_outline(ink).mask
    assert mask[60, 100]
    assert mask[150, 30]
    assert not mask[130, 100]


@pytest.mark.parametrize("width", [1, 2, 5, 9])
@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2, 2.5])
def test_a_stroke_has_two_ends_that_point_out_of_it(width: int, angle: float) -> None:
    along = np.array([np.cos(angle), np.sin(angle)])
    middle = np.array([100, 100])
    ends = stroke_ends(
        drawn([tuple(np.rint(middle + s * 60 * along).astype(int)) for s in (-1, 1)], width=width) > 0.5,
        width,
    )
    assert len(ends) == 2
    for sign in (-1, 1):
        nearest = np.argmin(np.hypot(*(ends.points - middle - sign * 60 * along).T))
        assert np.hypot(*(ends.points[nearest] - middle - sign * 60 * along)) <= 2 + width / 2
        assert ends.ways[nearest] @ along * sign > 0.95


def test_a_closed_line_has_no_end_and_a_crossing_is_none() -> None:
    assert len(stroke_ends(INK > 0.5, 3)) == 0
    cross = drawn([(40, 100), (160, 100)], [(100, 40), (100, 160)])
    assert len(stroke_ends(cross > 0.5, 2)) == 4


def test_bridges_go_on_where_lines_point_and_cross_no_other() -> None:
    ink = drawn([(20, 50), (80, 50)], [(120, 50), (180, 50)], [(20, 150), (80, 150)])
    inked = ink > 0.5
    found = bridges(stroke_ends(inked, 2), inked, 160, 80)
    assert sorted([found[0].start[0], found[0].end[0]]) == pytest.approx([80, 120], abs=2)
    assert found[0].cost == pytest.approx(40, abs=4)
    assert all(each.cost <= 80 for each in found)
    walled = drawn([(20, 50), (80, 50)], [(120, 50), (180, 50)], [(100, 10), (100, 90)]) > 0.5
    for each in bridges(stroke_ends(walled, 2), walled, 160, 80):
        assert (each.start[0] - 100) * (each.end[0] - 100) >= -3 * 60  # each stays on its side


def test_hatching_is_not_bridged() -> None:
    ink = np.zeros((512, 512), np.float32)
    ink[8:-8:10, 20:490] = 1
    for column in range(20, 490, 40):
        ink[:, column : column + 20] = 0
    assert len(stroke_ends(ink > 0.5, 1)) > 400
    assert bridges(stroke_ends(ink > 0.5, 1), ink > 0.5, 500, 100) == []
