"""The studio's two panes as one view: they move together, points are on both, one can have all the room."""

import numpy as np
import pytest
from numpy.typing import NDArray
from studio_page import SIDE, Studio

# A server and a browser take seconds to start; every test begins with a circle, painted.
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("ball")]
MIDDLE = SIDE / 2


def extents(studio: Studio) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return left, top, right and bottom of the ink in its pane, and of the map in the other."""
    studio.page.mouse.move(2, 2)
    screen = studio.screen().astype(int)
    found = []
    for canvas in ("#board", "#overlay"):
        box = studio.page.locator(canvas).bounding_box()
        assert box is not None
        left, top = round(box["x"]) + 8, round(box["y"]) + 8  # within the focus ring
        pane = screen[top : top + round(box["height"]) - 16, left : left + round(box["width"]) - 16]
        marked = pane.max(-1) < 100 if canvas == "#board" else np.ptp(pane, axis=-1) > 40
        rows, columns = np.nonzero(marked)
        found.append(
            np.array([columns.min(), rows.min(), columns.max(), rows.max()], float)
            + [left - box["x"], top - box["y"]] * 2
        )
    return found[0], found[1]


def test_both_panes_show_the_same_part_whichever_is_moved(studio: Studio) -> None:
    page = studio.page
    ink, map_ = extents(studio)
    np.testing.assert_allclose(ink, map_, atol=4)
    for canvas in ("#board", "#overlay"):
        box = page.locator(canvas).bounding_box()
        assert box is not None
        page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.4 * box["height"])
        page.mouse.wheel(0, 150)
        ink, map_ = extents(studio)
        np.testing.assert_allclose(ink, map_, atol=4)
    page.keyboard.press("v")
    box = page.locator("#overlay").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 170, steps=3)
    page.mouse.up()
    moved, map_ = extents(studio)
    np.testing.assert_allclose(moved, map_, atol=4)
    np.testing.assert_allclose(moved - ink, [60, -30, 60, -30], atol=3)
    page.keyboard.press("0")
    upright = extents(studio)[1]
    page.keyboard.press(".")  # a circle looks the same, but its colours turn
    before = studio.shown(MIDDLE + 60, MIDDLE)
    for _ in range(5):
        page.keyboard.press(".")
    np.testing.assert_allclose(extents(studio)[1], upright, atol=4)
    after = studio.shown(MIDDLE, MIDDLE + 60)  # 90° in all: what was on the right is below
    assert np.linalg.norm(after - studio.shown(MIDDLE + 60, MIDDLE)) > 0.3
    assert after[0] > 0.2
    assert before is not None


def test_a_point_is_pinned_and_moved_on_the_result(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("h")
    page.mouse.click(*studio.on_result(100, 110))
    assert page.locator("#chips .chip").count() == 1
    assert page.evaluate("document.getElementById('point').parentElement.id") == "result"
    with studio.repainting():
        studio.turn(0.6, -0.5)
    bent = studio.shown(100, 110)
    np.testing.assert_allclose(bent[:2], [0.6, -0.5], atol=0.08)
    page.locator("#point-done").click()
    page.mouse.move(*studio.on_result(100, 110))
    page.mouse.down()
    with studio.repainting():  # on a busy machine all is painted before the hand lets go, and nothing after
        page.mouse.move(*studio.on_result(130, 140), steps=4)
        page.mouse.up()
    np.testing.assert_allclose(studio.shown(130, 140), bent, atol=0.12)
    assert np.linalg.norm(studio.shown(100, 110) - bent) > 0.3


def test_a_sheet_that_shows_nothing_is_not_blended_with_the_map(studio: Studio) -> None:
    page, sheet = studio.page, studio.page.locator("#result-sheet")
    sheet.wait_for(state="hidden")
    at = studio.on_result(MIDDLE + 80, MIDDLE)  # on the circle
    page.keyboard.press("o")
    sheet.wait_for(state="visible")
    assert studio.screen()[round(at[1]), round(at[0])].max() < 100
    page.keyboard.press("o")
    sheet.wait_for(state="hidden")
    # What is drawn while it is hidden is on it when it is shown again.
    with studio.repainting():
        studio.line((MIDDLE - 20, MIDDLE), (MIDDLE + 20, MIDDLE))
    page.keyboard.press("o")
    sheet.wait_for(state="visible")
    page.mouse.move(2, 2)
    at = studio.on_result(MIDDLE, MIDDLE)
    assert studio.screen()[round(at[1]), round(at[0])].max() < 100


def test_a_divider_shows_the_drawing_beside_its_map(studio: Studio) -> None:
    page = studio.page
    at = studio.on_result(MIDDLE - 60, MIDDLE), studio.on_result(MIDDLE + 60, MIDDLE)
    page.locator("#compare").click()
    page.keyboard.press("ArrowRight")
    assert page.locator("#divider").get_attribute("aria-valuenow") == "55"
    left, right = (studio.screen()[round(y), round(x)] for x, y in at)
    assert left.min() > 250  # paper
    assert np.ptp(right.astype(int)) > 40  # the map
    divider = page.locator("#divider").bounding_box()
    assert divider is not None
    page.mouse.move(divider["x"] + divider["width"] / 2, divider["y"] + 40)
    page.mouse.down()
    page.mouse.move(at[0][0] - 40, divider["y"] + 40)
    page.mouse.up()
    assert np.ptp(studio.screen()[round(at[0][1]), round(at[0][0])].astype(int)) > 40
    page.keyboard.press("c")
    assert page.locator("#divider").is_hidden()


def test_a_large_result_is_drawn_on_and_its_lines_are_seen(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("f")
    assert page.locator("#board").is_hidden()
    assert page.locator("#size").is_visible()  # the pen's options stay
    wide = page.locator("#overlay").bounding_box()
    assert wide is not None
    assert wide["width"] > 1000
    studio.wait_for_frame()  # in which the pane learns of its size
    with studio.repainting():
        page.mouse.move(*studio.on_result(40, 20))
        page.mouse.down()
        page.mouse.move(*studio.on_result(90, 20), steps=4)
        page.mouse.up()
    page.mouse.move(2, 2)
    column, row = map(round, studio.on_result(60, 20))
    assert studio.screen()[row, column].max() < 100
    page.keyboard.press("f")
    assert studio.inked(60, 20)
    page.locator("#layout-drawing").click()
    assert page.locator("#overlay").is_hidden()
    assert studio.inked(60, 20)


def test_where_the_model_is_unsure_is_amber(studio: Studio) -> None:
    page = studio.page
    at = [studio.on_result(MIDDLE + x, MIDDLE) for x in (-50, 50)]
    before = [studio.screen()[round(y), round(x)].astype(int) for x, y in at]
    page.locator("#doubt").click()
    assert page.locator("#doubt").get_attribute("aria-pressed") == "true"
    page.locator("#result-sheet").wait_for()  # the model's answer, over the map
    page.mouse.move(2, 2)
    after = [studio.screen()[round(y), round(x)].astype(int) for x, y in at]
    changes = [np.abs(a - b).sum() for a, b in zip(after, before, strict=True)]
    assert max(changes) > 30, (changes, studio.status())
    page.locator("#doubt").click()
    assert page.locator("#doubt").get_attribute("aria-pressed") == "false"
    page.mouse.move(2, 2)
    for (x, y), colour in zip(at, before, strict=True):
        np.testing.assert_allclose(studio.screen()[round(y), round(x)], colour, atol=3)


def test_the_result_is_repeated_or_shows_its_pixels(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        page.keyboard.press("g")  # round, so that each pixel has another colour
    page.locator("#overlay").evaluate("(canvas) => { canvas.style.visibility = 'hidden'; }")
    (left, _), (right, _) = studio.on_result(0, 0), studio.on_result(SIDE, SIDE)
    column, row = (round(value) for value in studio.on_result(SIDE / 2, SIDE / 2))
    before = studio.screen()
    page.keyboard.press("t")
    tiles = studio.screen()
    pitch = (right - left) / 3
    for aside in (-20, 0, 25):
        middle = tiles[row + 9, column + aside].astype(int)
        for x, y in ((-1, 0), (1, 0), (0, -1), (1, 1)):
            other = tiles[row + 9 + round(y * pitch), column + aside + round(x * pitch)].astype(int)
            assert np.abs(other - middle).max() < 8
    page.keyboard.press("t")
    assert np.array_equal(
        studio.screen()[row, column - 90 : column + 90], before[row, column - 90 : column + 90]
    )
    for _ in range(6):
        page.keyboard.press("+")
    smooth = studio.screen()[row, column - 90 : column + 90]
    page.keyboard.press("k")
    pixels = studio.screen()[row, column - 90 : column + 90]

    def areas(line: NDArray[np.uint8]) -> int:
        changes = np.flatnonzero((np.diff(line.astype(int), axis=0) != 0).any(-1))
        return int((np.diff(changes) > 2).sum())  # where two pixels of the map meet, their colours may mix

    assert areas(pixels) < 0.8 * areas(smooth)
    assert page.locator("#pixelated").get_attribute("aria-pressed") == "true"
