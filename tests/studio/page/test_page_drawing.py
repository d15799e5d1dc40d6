"""The studio's page under the mouse: lines, points, undo, and what the map makes of them."""

import itertools
import math

import numpy as np
import pytest
from studio_page import SIDE, Studio

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start


def test_nothing_lies_on_the_empty_paper(studio: Studio) -> None:
    """The first stroke may begin anywhere; samples are offered beside it."""
    places = studio.along(*((x, y) for x in range(8, SIDE, 24) for y in range(8, SIDE, 24)))
    there = "(places) => places.map(([x, y]) => document.elementFromPoint(x, y).id)"
    assert set(studio.page.evaluate(there, places)) == {"board"}
    assert studio.page.locator("#samples button").count() == 3


def test_the_mouse_draws_and_the_model_paints(ball: Studio) -> None:
    middle = SIDE / 2
    assert ball.inked(middle + 80, middle)
    assert not ball.inked(middle, middle)
    left, right = ball.shown(middle - 60, middle), ball.shown(middle + 60, middle)
    top, bottom = ball.shown(middle, middle - 60), ball.shown(middle, middle + 60)
    # The ramp's x grows to the right and its y upwards, and so must what is on show.
    assert left[0] < -0.2 < 0.2 < right[0]
    assert bottom[1] < -0.2 < 0.2 < top[1]
    for normal in (left, right, top, bottom):
        np.testing.assert_allclose(np.linalg.norm(normal), 1, atol=0.02)


def test_a_point_changes_the_map_near_it_and_nowhere_else(ball: Studio) -> None:
    far = SIDE / 2 + 60, SIDE / 2
    before_near, before_far = ball.shown(100, 110), ball.shown(*far)
    ball.pin(100, 110)
    with ball.repainting():
        ball.turn(0.6, -0.5)
    wanted = np.array([0.6, -0.5, np.sqrt(1 - 0.61)])
    near = ball.shown(100, 110)
    angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(near, wanted)), near @ wanted))
    assert angle < 6
    assert np.linalg.norm(near - before_near) > 0.5
    np.testing.assert_allclose(ball.shown(*far), before_far, atol=0.03)


def test_undo_and_redo_take_back_points_and_lines(ball: Studio) -> None:
    page, chips = ball.page, ball.page.locator("#chips .chip")
    bare = ball.shown(100, 110)
    ball.pin(100, 110)
    with ball.repainting():
        ball.turn(0.6, -0.5)
    turned = ball.shown(100, 110)
    with ball.repainting():
        page.keyboard.press("Control+z")
    np.testing.assert_allclose(ball.shown(100, 110), bare, atol=0.03)
    assert chips.count() == 1  # the turn is undone, the point is there
    with ball.repainting():
        page.keyboard.press("Control+Shift+z")
    np.testing.assert_allclose(ball.shown(100, 110), turned, atol=0.01)
    for _ in range(3):
        page.keyboard.press("Control+z")
    assert chips.count() == 0
    assert not ball.inked(SIDE / 2 + 80, SIDE / 2)
    assert page.locator("#empty-result").is_visible()
    assert page.locator("#undo").is_disabled()
    with ball.repainting():
        page.locator("#redo").click()
    assert ball.inked(SIDE / 2 + 80, SIDE / 2)


def test_the_eraser_erases_and_that_is_undone_too(ball: Studio) -> None:
    middle = SIDE / 2
    ball.page.keyboard.press("e")
    ball.line((middle + 70, middle), (middle + 90, middle))
    assert not ball.inked(middle + 80, middle)
    assert ball.inked(middle - 80, middle)
    ball.page.locator("#undo").click()
    assert ball.inked(middle + 80, middle)


def test_points_are_moved_and_removed(ball: Studio) -> None:
    ball.pin(100, 110)
    with ball.repainting():
        ball.turn(0.6, -0.5)
    bent = ball.shown(100, 110)
    ball.page.locator("#point-done").click()
    with ball.repainting():
        ball.line((100, 110), (110, 120), (150, 150))
    assert np.linalg.norm(ball.shown(100, 110) - bent) > 0.5
    np.testing.assert_allclose(ball.shown(150, 150), bent, atol=0.15)
    with ball.repainting():
        ball.page.locator("#point-remove").click()
    assert np.linalg.norm(ball.shown(150, 150) - bent) > 0.5
    assert ball.page.locator("#chips .chip").count() == 0


def test_suggested_points_are_taken_by_a_click(ball: Studio) -> None:
    ball.page.locator("#tool-hint").click()
    ball.page.locator("#suggest").click()
    offers = ball.page.locator("#chips .offer")
    offers.first.wait_for()
    count = offers.count()
    offers.first.click()
    assert offers.count() == count - 1
    assert ball.page.locator("#chips .chip:not(.offer)").count() == 1
    assert ball.page.locator("#point").is_visible()


def test_a_pens_pressure_sets_the_width(studio: Studio) -> None:
    # Playwright has no pen: the events are made as Chromium makes them.
    draw = """([from, to, pressure]) => {
      const board = document.getElementById("board");
      board.setPointerCapture = () => {};
      const send = (type, [x, y]) => board.dispatchEvent(new PointerEvent(type, {
        pointerId: 7, pointerType: "pen", pressure, clientX: x, clientY: y, button: 0, bubbles: true }));
      send("pointerdown", from);
      send("pointermove", to);
      send("pointerup", to);
    }"""
    for y, pressure in ((60, 0.1), (120, 1.0)):
        ends = [studio.on_board(40, y), studio.on_board(200, y)]
        with studio.repainting():
            studio.page.evaluate(draw, [*ends, pressure])
    studio.page.mouse.move(2, 2)

    picture = studio.screen()

    def thickness(y: int) -> int:
        column, row = map(round, studio.on_board(120, y))
        return int((picture[row - 60 : row + 60, column].max(axis=-1) < 128).sum())

    assert thickness(120) > 3 * thickness(60) > 0


def test_zoom_keeps_what_is_drawn_in_place(ball: Studio) -> None:
    x, y = ball.on_board(SIDE / 2 + 80, SIDE / 2)
    ball.page.mouse.move(x, y)
    ball.page.mouse.wheel(0, -300)
    ball.page.mouse.move(2, 2)
    assert ball.screen()[round(y), round(x)].max() < 128  # still under the pointer
    ball.page.locator("#zoom-fit").click()
    assert ball.inked(SIDE / 2 - 80, SIDE / 2)


def drawn_points(studio: Studio, name: str) -> list[tuple[float, float]]:
    """Return the places of the only line, as a saved project has it."""
    project = studio.page.evaluate(
        "name => fetch(`/api/projects/${name}`).then((answer) => answer.json())", name
    )
    (stroke,) = project["layers"][0]["strokes"]
    return list(zip(stroke["points"][::3], stroke["points"][1::3], strict=True))


HELD = "milliseconds => { document.documentElement.dataset.held = milliseconds; }"
"""How long a hand is to hold still to make a shape of its stroke."""
ELLIPSE = [(128 + 80 * math.cos(k / 10), 128 + 60 * math.sin(k / 10)) for k in range(64)]


def draw_and_hold(studio: Studio, way: list[tuple[float, float]]) -> None:
    """Draw a stroke and hold it still at its end until it is a shape."""
    page = studio.page
    first, *others, last = studio.along(*way)
    page.mouse.move(*first)
    page.mouse.down()
    for at in others:
        page.mouse.move(*at)
    page.evaluate(HELD, 600)
    with studio.saying("Straightened."):
        page.mouse.move(*last)


def test_a_pause_within_a_stroke_loses_nothing_of_it(studio: Studio) -> None:
    page = studio.page
    draw_and_hold(studio, ELLIPSE)
    page.evaluate(HELD, 1e9)
    for at in studio.along(*((x, 128) for x in range(208, 252, 4))):
        page.mouse.move(*at)
    page.mouse.up()
    studio.save_as("paused")
    points = drawn_points(studio, "paused")
    assert max(x for x, _ in points) > 240
    assert len(points) > 60


def test_a_busy_page_takes_no_stroke_for_one_that_is_held(studio: Studio) -> None:
    page = studio.page
    page.evaluate(HELD, 2000)  # the machine that tests may itself pause
    first, *others = studio.along(*ELLIPSE)
    page.mouse.move(*first)
    page.mouse.down()
    for number, at in enumerate(others):
        if number == 40:
            page.evaluate(
                """() => setTimeout(() => {
                  const start = performance.now();
                  while (performance.now() - start < 2500);
                })"""
            )
        page.mouse.move(*at)
    page.mouse.up()
    page.locator("#history summary").click()
    rows = page.locator("#history-list button")
    rows.first.wait_for()
    assert rows.all_inner_texts() == ["Beginning", "Line"]


def test_far_back_in_history_the_list_shows_the_present_step_and_a_reload_keeps_both_ways(
    studio: Studio,
) -> None:
    page = studio.page
    page.evaluate(
        """([x, y]) => {
          const board = document.getElementById("board");
          board.setPointerCapture = () => {};
          const fire = (kind, i) => board.dispatchEvent(new PointerEvent(kind, {
            bubbles: true, isPrimary: true, pointerType: "mouse", clientX: x + (i % 60), clientY: y + i / 60,
          }));
          for (let i = 0; i < 320; i++) for (const kind of ["pointerdown", "pointerup"]) fire(kind, i);
          delete board.setPointerCapture;
          const undo = new KeyboardEvent("keydown", { key: "z", code: "KeyZ", ctrlKey: true, bubbles: true });
          for (let i = 0; i < 230; i++) document.body.dispatchEvent(undo);
        }""",
        list(studio.on_board(60, 60)),
    )
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list button.undone").count() == 109
    studio.wait_for_store(lambda kept: len(kept["doc"]["layers"][0]["strokes"]) == 90)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list button.undone").count() == 49
    assert page.locator("#undo").is_enabled()


@pytest.mark.parametrize("meant", ["square", "circle", "line"])
def test_a_stroke_held_at_its_end_becomes_the_shape_that_it_means(studio: Studio, meant: str) -> None:
    page = studio.page
    corners = [(60, 62), (190, 58), (194, 188), (58, 192), (60, 66)]
    if meant == "square":
        way = [
            (x0 + (x1 - x0) * k / 12 + (k % 3 - 1), y0 + (y1 - y0) * k / 12 + (k % 2))
            for (x0, y0), (x1, y1) in itertools.pairwise(corners)
            for k in range(12)
        ]
    elif meant == "circle":
        angles = [2 * math.pi * k / 60 for k in range(60)]
        way = [
            (128 + (70 + k % 3) * math.cos(a), 128 + (70 + k % 2) * math.sin(a)) for k, a in enumerate(angles)
        ]
    else:
        way = [(40 + 4 * k, 100 + k % 3) for k in range(40)]
    draw_and_hold(studio, way)
    page.mouse.up()
    studio.save_as(meant)
    points = drawn_points(studio, meant)
    if meant == "square":
        assert len(points) == 10
        assert all(one == other for one, other in zip(points[::2], points[1::2], strict=True))
        assert {round(x / 10) for x, _ in points} == {6, 19}
        assert len({x for x, _ in points}) == len({y for _, y in points}) == 2  # level, with right angles
    elif meant == "circle":
        assert len(points) == 97
        radii = [math.hypot(x - 128.5, y - 128.5) for x, y in points]
        assert max(radii) - min(radii) < 2
    else:
        assert points[0][1] == points[1][1]  # level
    page.keyboard.press("Control+z")
    with studio.saying("Saved"):
        page.keyboard.press("Control+s")
    assert len(drawn_points(studio, meant)) not in (len(points), 10)
