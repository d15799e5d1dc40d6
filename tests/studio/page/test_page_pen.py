"""The studio's page under a pen, in a browser with its storage on the disk: pressure, hovering, a palm."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from studio_page import SIDE, Hand, Pen, Server, Studio, sending_nothing_late

from chromium import profile

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2


@pytest.fixture
def studio(server: Server, tmp_path: Path) -> Iterator[Studio]:
    """An empty drawing."""
    with profile(tmp_path / "profile") as context:
        page = context.pages[0]
        with sending_nothing_late(page):
            studio = Studio(page, server.url)
            studio.new()
            yield studio


def test_on_a_phone_a_stroke_may_begin_on_a_sample(studio: Studio) -> None:
    studio.page.set_viewport_size({"width": 390, "height": 844})
    studio.wait_for_frame()
    box = studio.page.locator("#samples button").first.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    hand = Hand(studio)
    with studio.repainting():
        hand.put((x, y))
        for dx, dy in ((20, 0), (60, 0), (120, 0), (120, 90), (0, 90), (0, 40), (0, 0)):
            hand.move((x + dx, y + dy))
        hand.lift()
    studio.page.locator("#history summary").click()
    rows = studio.page.locator("#history-list button")
    rows.first.wait_for()
    assert rows.all_inner_texts() == ["Beginning", "Line"]


def thickness(studio: Studio, x: float) -> float:
    """Return how many pixels of the drawing are dark in a column."""
    studio.page.mouse.move(2, 2)
    column, top = studio.on_board(x, 20)
    bottom = studio.on_board(x, SIDE - 20)[1]
    dark = studio.screen()[round(top) : round(bottom), round(column)].max(axis=1) < 128
    return float(dark.sum()) * (SIDE - 40) / (bottom - top)


def stroke(studio: Studio, y: float, pressures: tuple[float, float]) -> None:
    """Draw from left to right, with a pressure that changes evenly."""
    pen = Pen(studio)
    pen.hover(studio.on_board(60, y))
    pen.down(studio.on_board(60, y), pressures[0])
    for share in np.linspace(0, 1, 20):
        pressure = pressures[0] + share * (pressures[1] - pressures[0])
        pen.move(studio.on_board(60 + 140 * share, y), float(pressure))
    pen.up(studio.on_board(200, y))


def test_a_line_is_as_wide_as_the_pen_is_pressed(studio: Studio) -> None:
    for _ in range(4):
        studio.page.keyboard.press("]")
    stroke(studio, MIDDLE, (0.1, 1.0))
    light, middle, firm = (thickness(studio, x) for x in (70, 130, 190))
    assert light < 0.7 * middle < 0.7 * firm


def test_a_stroke_that_is_pressed_less_and_less_ends_thin(studio: Studio) -> None:
    pen = Pen(studio)
    pen.down(studio.on_board(60, MIDDLE), 0.6)
    for step in range(1, 15):
        pen.move(studio.on_board(60 + 8 * step, MIDDLE), max(0, 0.6 - 0.05 * step))
    pen.up(studio.on_board(172, MIDDLE))
    assert thickness(studio, 170) < thickness(studio, 100) / 2


def test_the_pens_other_end_erases(studio: Studio) -> None:
    stroke(studio, MIDDLE, (0.6, 0.6))
    assert studio.inked(130, MIDDLE)
    # Chromium's protocol has no eraser, so the page is told in its place.
    at = studio.on_board(130, MIDDLE)
    studio.page.evaluate(
        """([x, y]) => {
            const common = {bubbles: true, pointerId: 77, pointerType: "pen", pressure: 0.5};
            const board = document.getElementById("board");
            board.setPointerCapture = () => {};
            const tell = (kind, clientX, clientY, more) =>
              board.dispatchEvent(new PointerEvent(kind, {...common, clientX, clientY, ...more}));
            tell("pointerdown", x, y - 20, {button: 5, buttons: 32});
            const moved = {button: -1, buttons: 32};
            for (let step = -15; step <= 20; step += 5) tell("pointermove", x, y + step, moved);
            tell("pointerup", x, y + 20, {button: 5, buttons: 0});
            delete board.setPointerCapture;
        }""",
        list(at),
    )
    assert not studio.inked(130, MIDDLE)
    assert studio.inked(70, MIDDLE)
    assert studio.page.locator("#tool-pen[aria-pressed=true]").count() == 1


def test_a_second_pen_keeps_the_stroke_of_the_first(studio: Studio) -> None:
    # Chromium's protocol has one pen, so the page is told in its place.
    studio.page.evaluate(
        """(places) => {
            const board = document.getElementById("board");
            board.setPointerCapture = () => {};
            const tell = (kind, pointerId, [clientX, clientY]) =>
              board.dispatchEvent(new PointerEvent(kind, {
                bubbles: true, pointerId, pointerType: "pen", pressure: 0.5, clientX, clientY,
                button: kind === "pointermove" ? -1 : 0, buttons: kind === "pointerup" ? 0 : 1,
              }));
            const [first, second] = places;
            tell("pointerdown", 77, first[0]);
            for (const at of first.slice(1, -1)) tell("pointermove", 77, at);
            tell("pointerdown", 78, second[0]);
            tell("pointermove", 77, first.at(-1));
            for (const at of second.slice(1)) tell("pointermove", 78, at);
            tell("pointerup", 77, first.at(-1));
            tell("pointerup", 78, second.at(-1));
            delete board.setPointerCapture;
        }""",
        [studio.along(*((x, y) for x in range(60, 201, 10))) for y in (80, 160)],
    )
    assert all(studio.inked(x, y) for x in (70, 150) for y in (80, 160))
    assert not studio.inked(130, 120)  # nothing joins them
    studio.page.locator("#history summary").click()
    rows = studio.page.locator("#history-list button")
    rows.first.wait_for()
    assert rows.all_inner_texts() == ["Beginning", "Line", "Line"]


def test_a_hovering_pen_shows_how_wide_it_draws(studio: Studio) -> None:
    for _ in range(4):
        studio.page.keyboard.press("]")
    x, y = (round(each) for each in studio.on_board(60, 60))

    def around() -> NDArray[np.int64]:
        return studio.screen()[y - 40 : y + 41, x - 40 : x + 41].astype(np.int64)

    before = around()
    Pen(studio).hover((x, y))
    rows, columns = np.nonzero(np.abs(around() - before).max(axis=2) > 40)
    assert len(rows)
    for side in (rows, columns):
        assert abs((side.min() + side.max()) / 2 - 40) < 2


@pytest.mark.parametrize("first", [True, False], ids=["palm first", "pen first"])
def test_a_palm_beside_the_pen_neither_draws_nor_stops_it(studio: Studio, *, first: bool) -> None:
    palm, pen = Hand(studio), Pen(studio)
    on_palm = studio.on_board(200, 220)
    studio.page.locator("#zoom-fit").click()
    if first:
        palm.put(on_palm)
        palm.move((on_palm[0] + 6, on_palm[1] + 6))
    pen.down(studio.on_board(60, 100))
    for step in range(1, 15):
        pen.move(studio.on_board(60 + 10 * step, 100))
        if step == 4 and not first:
            palm.put(on_palm)
        if step > 5:
            palm.move((on_palm[0] + 2 * step, on_palm[1] + step))
    pen.up(studio.on_board(200, 100))
    palm.lift()
    assert all(studio.inked(x, 100) for x in (70, 130, 190))
    column, row = (round(each) for each in on_palm)
    assert studio.screen()[row - 4 : row + 20, column - 4 : column + 30].max(axis=2).min() > 128
    studio.page.locator("#history summary").click()
    rows = studio.page.locator("#history-list button")
    rows.first.wait_for()
    assert rows.all_inner_texts() == ["Beginning", "Line"]
