"""Directions given by hand on the studio's page: pins that hold, regions, the direction brush."""

import json
import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import NDArray
from studio_page import RADIUS, SIDE, Studio

if TYPE_CHECKING:
    from playwright.sync_api import Request

# A server and a browser take seconds to start; every test begins with a circle, painted.
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("ball")]
MIDDLE = SIDE / 2


def degrees(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))


def direction(x: float, y: float) -> NDArray[np.float64]:
    return np.array([x, y, np.sqrt(1 - x * x - y * y)])


def test_marks_that_are_removed_leave_nothing_behind(studio: Studio) -> None:
    """A frame of nothing but clearing does not always reach the screen: see `clear` in canvas.js."""
    page = studio.page
    page.keyboard.press("h")
    page.mouse.move(2, 2)
    before = studio.screen()
    studio.pin(MIDDLE, MIDDLE)
    page.keyboard.press("Delete")
    page.wait_for_function("() => document.querySelectorAll('#chips .chip').length === 0")
    page.mouse.move(2, 2)
    (left, top), (right, bottom) = studio.on_board(0, 0), studio.on_board(SIDE, SIDE)
    place = np.s_[round(top) : round(bottom), round(left) : round(right)]
    assert np.array_equal(studio.screen()[place], before[place])
    drawn = page.evaluate(
        """async () => {
          const { src } = document.querySelector("script[type=module]");
          const { clear } = await import(src.replace("main", "drawing/canvas"));
          const canvas = Object.assign(document.createElement("canvas"), { width: 4, height: 4 });
          const context = canvas.getContext("2d");
          context.fillRect(0, 0, 4, 4);
          clear(context);
          return [...context.getImageData(0, 0, 4, 4).data].map((value, i) => i % 4 === 3 && value);
        }"""
    )
    alpha = [value for value in drawn if value is not False]
    assert 0 < alpha[0] < 4  # a drawing, which nobody sees
    assert not any(alpha[1:])


def test_opposed_pins_near_one_another_hold(studio: Studio) -> None:
    for x, lean in ((MIDDLE - 8, -0.7), (MIDDLE + 8, 0.7)):
        studio.pin(x, MIDDLE)
        with studio.repainting():
            studio.turn(lean, 0)
        studio.page.locator("#point-done").click()
    studio.page.locator("#tool-pen").click()
    for x, lean in ((MIDDLE - 8, -0.7), (MIDDLE + 8, 0.7)):
        # The mark covers the drawing, not the result.
        assert degrees(studio.shown(x + 0.5, MIDDLE + 0.5), direction(lean, 0)) < 4


@pytest.mark.parametrize("by", ["slider", "ring"])
def test_a_pins_reach_can_be_changed_and_is_undone(studio: Studio, by: str) -> None:
    studio.pin(MIDDLE, MIDDLE)
    with studio.repainting():
        studio.turn(0, 0.8)
    beside = studio.shown(MIDDLE + 30, MIDDLE)
    with studio.repainting():
        if by == "slider":
            studio.page.locator("#point-reach").fill("90")
            studio.page.locator("#point-reach").dispatch_event("change")
        else:
            knob = 30 * math.sqrt(0.5)  # pixels of the screen to the left and down, at least
            (x, y), (further, _) = studio.on_board(MIDDLE, MIDDLE), studio.on_board(MIDDLE + 9, MIDDLE)
            knob = max(knob, further - x)  # the usual reach is 12.8 pixels of the drawing
            studio.page.mouse.move(x - knob, y + knob)
            studio.page.mouse.down()
            studio.page.mouse.move(*studio.on_board(MIDDLE - 60, MIDDLE + 60), steps=3)
            studio.page.mouse.up()
    assert degrees(studio.shown(MIDDLE + 30, MIDDLE), beside) > 5
    with studio.repainting():
        studio.page.keyboard.press("Control+z")
    assert degrees(studio.shown(MIDDLE + 30, MIDDLE), beside) < 1


def test_a_region_is_turned_as_a_whole_and_a_brush_gives_a_direction(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("r")
    box = [(90, 90), (130, 90), (130, 120), (90, 120), (90, 92)]
    with studio.repainting():
        studio.line(*box)
    page.locator("#point").wait_for()
    before = [studio.shown(x, 105) for x in (97, 123)]
    with studio.repainting():
        studio.turn(0, 0.7)
    after = [studio.shown(x, 105) for x in (97, 123)]
    assert degrees((after[0] + after[1]) / 2, direction(0, 0.7)) < 12
    assert abs(degrees(*before) - degrees(*after)) < 3  # as bent as it was
    page.keyboard.press("Escape")
    page.keyboard.press("d")
    with studio.repainting():
        studio.line((110, 160), (150, 160))
    with studio.repainting():
        studio.turn(-0.6, 0)
    assert degrees(studio.shown(130, 160), direction(-0.6, 0)) < 10
    page.keyboard.press("Escape")
    with studio.repainting():
        studio.line((110, 180), (150, 180))  # the same direction again
    assert degrees(studio.shown(130, 180), direction(-0.6, 0)) < 10
    page.keyboard.press("h")
    assert page.locator("#chips .area").count() == 3
    with studio.repainting():
        page.locator("#chips .area").nth(2).click()
        page.keyboard.press("Delete")
    assert page.locator("#chips .area").count() == 2


def test_the_brush_is_soft_and_strong_as_its_sliders_and_keys_say_and_smooths(studio: Studio) -> None:
    page = studio.page
    wanted = direction(-0.8, 0)
    before, beside = studio.shown(130, 120), studio.shown(130, 140)
    page.keyboard.press("d")
    page.locator("#brush-soft").fill("0")
    with studio.repainting():
        studio.line((80, 120), (180, 120))
    with studio.repainting():
        studio.turn(-0.8, 0)
    assert degrees(studio.shown(130, 120), wanted) < 4
    assert degrees(studio.shown(130, 140), wanted) < 6  # 20 of a radius of 24
    studio.stop_clock()
    with studio.repainting():
        page.locator("#brush-strength").fill("50")  # of the stroke that is chosen, and of the next
        page.locator("#brush-strength").dispatch_event("change")
    half = degrees(studio.shown(130, 120), before)
    assert half == pytest.approx(degrees(wanted, before) / 2, abs=4)
    with studio.repainting():
        page.keyboard.press("Shift+I")
        page.keyboard.press("Shift+I")
    assert degrees(studio.shown(130, 120), before) < half - 4
    with studio.repainting():
        page.keyboard.press("Control+z")  # all that followed one another is one step
    assert degrees(studio.shown(130, 120), wanted) < 4
    with studio.repainting():
        for _ in range(10):
            page.keyboard.press("u")
    assert degrees(studio.shown(130, 140), beside) < 6
    with studio.repainting():
        page.locator("#brush-soft").fill("0")
        page.locator("#brush-soft").dispatch_event("change")

    page.keyboard.press("w")
    assert page.locator("#point").is_hidden()
    step = degrees(studio.shown(130, 141), studio.shown(130, 147))  # across the stroke's hard edge
    page.locator("#brush-strength").fill("100")
    with studio.repainting():
        studio.line((90, 144), (170, 144))
    assert page.locator("#point").is_hidden()  # nothing is to be turned
    page.keyboard.press("p")
    assert degrees(studio.shown(130, 141), studio.shown(130, 147)) < 0.5 * step
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert page.locator("#brush-smooth").get_attribute("aria-pressed") == "true"
    assert page.locator("#brush-strength").input_value() == "100"


def test_a_click_makes_the_area_between_lines_a_region_and_selects_it_again(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((MIDDLE - RADIUS, MIDDLE), (MIDDLE + RADIUS, MIDDLE))
    page.keyboard.press("r")
    for at in ((MIDDLE, MIDDLE - 20), (MIDDLE + 40, MIDDLE - 10), (MIDDLE - 40, MIDDLE - 30)):
        page.mouse.click(*studio.on_board(*at))
        page.locator("#point").wait_for()
        assert page.locator("#form-of").inner_text() == "Region 1"
        page.keyboard.press("Escape")
    below = studio.shown(MIDDLE - 40, MIDDLE + 20)
    page.mouse.click(*studio.on_board(MIDDLE, MIDDLE - 20))
    with studio.repainting():
        page.locator("#form-choose").click()
        page.locator("#form-flat").click()
    flat = studio.shown(MIDDLE - 40, MIDDLE - 20), studio.shown(MIDDLE + 30, MIDDLE - 30)
    assert degrees(*flat) < 2
    assert degrees(studio.shown(MIDDLE - 40, MIDDLE + 20), below) < 3
    stored = studio.wait_for_store(lambda each: bool(each["doc"]["layers"][0]["areas"]))
    (area,) = stored["doc"]["layers"][0]["areas"]
    x, y = np.reshape(area["points"], (-1, 2)).T
    around = np.hypot(x - MIDDLE, y - MIDDLE)
    # Around the outline, which is 6 pixels wide, and along the middle of the line to the area below.
    assert np.all((np.abs(around - RADIUS - 3.5) < 2.5) | (np.abs(y - MIDDLE) < 4))
    page.keyboard.press("Escape")
    with studio.saying("open to the paper's edge"):
        page.mouse.click(*studio.on_board(6, 6))


def test_a_layer_and_a_region_take_a_form_by_buttons_sliders_and_keys(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("r")
    assert page.locator("#form-of").inner_text() == "Whole layer"
    with studio.repainting():
        page.locator("#form-choose").click()
        page.locator("#form-round").click()
    for x, y in ((40, 0), (0, -40), (-30, 30)):
        wanted = direction(x / RADIUS, -y / RADIUS)
        assert degrees(studio.shown(MIDDLE + x, MIDDLE + y), wanted) < 6
    with studio.repainting():
        page.keyboard.press("g")  # flat
    assert degrees(studio.shown(MIDDLE + 40, MIDDLE), direction(0, 0)) < 3
    page.locator("#form-bevel").focus()
    with studio.repainting():
        page.keyboard.press("End")
    assert degrees(studio.shown(MIDDLE + 40, MIDDLE), direction(math.sqrt(0.5), 0)) < 6
    with studio.repainting():
        studio.line((90, 90), (166, 90), (166, 166), (90, 166), (90, 92))
    assert page.locator("#form-of").inner_text() == "Region 1"
    with studio.repainting():
        page.locator("#form-choose").click()
        page.locator("#form-hollow").click()
    assert studio.shown(MIDDLE - 25, MIDDLE)[0] > 0.3  # it slopes inwards
    page.locator("#form-soft").focus()
    with studio.repainting():
        page.keyboard.press("End")
    assert abs(studio.shown(MIDDLE - 36, MIDDLE)[0]) > 0.3  # where it begins, the layer's bevel is left
    hollow = studio.shown(MIDDLE - 25, MIDDLE)
    studio.save_as("coin")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.wait_for_function("() => document.getElementById('result').ariaBusy === 'false'")
    assert degrees(studio.shown(MIDDLE - 25, MIDDLE), hollow) < 1
    with studio.repainting():
        for _ in range(6):
            page.keyboard.press("Control+z")
    page.locator("#history summary").click()
    page.locator("#history-list li").first.wait_for()
    assert page.locator("#history-list li").all_inner_texts().count("Form changed") == 5


def test_history_says_which_region_was_deleted_and_not_that_forms_changed(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("r")
    studio.line((60, 90), (110, 90), (110, 160), (60, 160), (60, 92))
    page.keyboard.press("Escape")  # the ball lies where the next one is drawn
    studio.line((140, 90), (190, 90), (190, 160), (140, 160), (140, 92))
    page.keyboard.press("g")
    page.keyboard.press("Escape")
    page.mouse.click(*studio.on_board(80, 118))
    assert page.locator("#form-of").inner_text() == "Region 1"
    page.keyboard.press("Delete")
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list li").all_inner_texts()[-2:] == ["Form changed", "Region deleted"]


def test_forms_are_shown_as_pictures_which_are_made_when_their_card_opens(studio: Studio) -> None:
    page = studio.page
    tabs: list[str] = []

    def note(request: "Request") -> None:
        body = request.post_data_buffer or b""
        if request.url.endswith("/api/predict"):
            tabs.append(json.loads(body[4 : 4 + int.from_bytes(body[:4], "little")])["tab"])

    page.on("request", note)
    page.keyboard.press("r")
    with studio.repainting():
        studio.line((90, 90), (166, 90), (166, 166), (90, 166), (90, 92))
    assert not any(tab.endswith(" form") for tab in tabs)
    page.locator("#form-choose").click()
    page.wait_for_function("() => document.querySelectorAll('#form-card canvas').length === 4")
    assert sum(tab.endswith(" form") for tab in tabs) == 4  # and no export shares their tab
    shown = page.evaluate(
        "[...document.querySelectorAll('#form-card canvas')].map((each) => each.toDataURL())"
    )
    assert len(set(shown)) == 4
    with studio.repainting():
        page.locator("#form-hollow").click()
    assert page.locator("#form-card").is_hidden()
    assert page.locator("#form-choose").get_attribute("aria-label") == "Form: Hollow"
    assert studio.shown(MIDDLE - 25, MIDDLE)[0] > 0.2


def test_suggestions_go_with_what_they_lie_on(studio: Studio) -> None:
    for x in (70, 190):
        with studio.repainting():
            studio.circle(x, 128, 48)
    page = studio.page
    page.locator("#tool-hint").click()
    page.locator("#suggest").click()
    offers = page.locator("#chips .offer")
    offers.first.wait_for()
    before = offers.count()
    with studio.repainting():
        page.keyboard.press("Control+z")
    assert 0 < offers.count() < before
