"""The studio's page for everybody: keys alone, WebGL or none, dark, narrow, and words for screen readers."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
import pytest
from studio_page import SIDE, Server, Studio, open_studio, sending_nothing_late

from chromium import browser
from chromium import page as open_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
LEAST_TARGET = 40
"""Pixels a finger needs."""


@pytest.fixture
def with_webgl() -> Iterator["Browser"]:
    with browser() as chromium:
        yield chromium


def dent(studio: Studio) -> None:
    """Draw a square, which takes few events."""
    low, high = 60, SIDE - 60
    with studio.repainting():
        studio.line((low, low), (high, low), (high, high), (low, high), (low, low))


def test_with_webgl_every_view_shows_something_and_none_complains(
    with_webgl: "Browser", server: Server
) -> None:
    with open_studio(with_webgl, server.url) as studio:
        studio.new()
        dent(studio)
        left, right = studio.shown(90, 128), studio.shown(166, 128)
        assert left[0] < -0.1 < 0.1 < right[0]
        for key in "2345":
            studio.page.keyboard.press(key)
            chosen = studio.page.locator('#views [aria-selected="true"]')
            assert chosen.get_attribute("data-view") == ["lit", "matcap", "flat", "relief"][int(key) - 2]
        assert studio.page.locator("#viewer-words").is_hidden()
        studio.page.wait_for_function("() => document.getElementById('note').textContent === ''")


def test_without_webgl_the_relief_says_why_there_is_none(studio: Studio) -> None:
    dent(studio)
    studio.page.keyboard.press("5")
    studio.page.locator("#viewer-words", has_text="WebGL").wait_for()


def test_the_relief_says_in_its_pane_why_there_is_none_and_other_views_do_not(
    with_webgl: "Browser", server: Server
) -> None:
    refused = "status of 400"
    with open_studio(with_webgl, server.url, tolerate=(refused,)) as studio:
        page = studio.page
        studio.new()
        dent(studio)
        page.route("**/api/height", lambda route: route.fulfill(status=400, json={"error": "not here"}))
        page.keyboard.press("5")
        page.locator("#viewer-words", has_text="Not here.").wait_for()
        assert page.locator("#problem").is_hidden()
        page.keyboard.press("2")
        assert page.locator("#viewer-words").is_hidden()
        page.unroute("**/api/height")


def test_keys_alone_draw_pin_turn_and_undo(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page, press = studio.page, studio.page.keyboard.press
        page.locator("#new").focus()
        press("Enter")
        for _ in range(2):
            press("Tab")  # the size 512
        press("Enter")
        page.locator("#new-dialog button.strong").focus()
        with studio.answering("new-dialog"):
            press("Enter")
        page.locator("#board").focus()
        for key, times in (("ArrowLeft", 3), ("ArrowUp", 3)):
            for _ in range(times):
                press(f"Shift+{key}")
        press("Enter")
        assert studio.status() == "Pen down."
        for key in ("ArrowRight", "ArrowDown", "ArrowLeft", "ArrowUp"):
            for _ in range(6):
                press(f"Shift+{key}")
        with studio.repainting(begun=True):
            press("Enter")
        for key in ("ArrowRight", "ArrowDown"):
            for _ in range(3):
                press(f"Shift+{key}")
        press("h")
        with studio.repainting():
            press("Enter")
        press("n")
        assert page.evaluate("document.activeElement.id") == "ball"
        before = page.locator("#ball").get_attribute("aria-label")
        studio.stop_clock()
        with studio.repainting():
            for _ in range(4):
                press("ArrowRight")
        after = page.locator("#ball").get_attribute("aria-label")
        assert before != after
        assert after is not None
        assert "right" in after
        press("Control+z")  # presses that follow one another are one step
        assert page.locator("#ball").get_attribute("aria-label") == before
        press("Control+y")
        press("n")
        press("Delete")
        assert page.locator("#chips .chip").count() == 0
        press("Control+z")
        assert page.locator("#chips .chip").count() == 1


def test_the_first_enter_on_the_drawing_puts_the_pen_down(studio: Studio) -> None:
    page, press = studio.page, studio.page.keyboard.press
    page.locator("#board").focus()
    for key in ("Enter", *["Shift+ArrowRight"] * 3, "Enter"):
        press(key)
    assert studio.status() == "Pen up."
    assert studio.inked(SIDE / 2 + 30, SIDE / 2)


def test_every_control_has_a_name_and_room_for_a_finger(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        dent(studio)
        with studio.repainting():
            studio.pin(128, 128)
        controls = studio.page.locator("button:visible, summary:visible, select:visible, input:visible")
        assert controls.count() > 20
        for control in controls.all():
            name = control.evaluate(
                "e => e.ariaLabel || e.textContent.trim() || e.labels?.[0]?.textContent.trim()"
            )
            assert name, control.evaluate("e => e.outerHTML")
            box = control.bounding_box()
            assert box is not None
            assert box["height"] >= LEAST_TARGET, name
            assert box["width"] >= LEAST_TARGET, name
        assert studio.page.locator("#status").get_attribute("aria-live") == "polite"
        assert studio.page.locator("#point-handle").get_attribute("role") == "button"
        studio.page.locator("#point-handle").focus()
        at = studio.page.locator("#point").bounding_box()
        for key in ("ArrowDown", "ArrowRight"):  # one of them may be at an edge
            studio.page.keyboard.press(key)
        assert studio.page.locator("#point").bounding_box() != at


def test_tooltips_name_the_keys_and_the_help_begins_at_its_start(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, height=500) as studio:
        page = studio.page
        for button, keys in {
            "tool-pen": "Pen (P)",
            "undo": "Undo (Ctrl+Z)",
            "lines": "Lines over the result (O)",
        }.items():
            assert page.locator(f"#{button}").get_attribute("title") == keys
        page.keyboard.press("?")
        dialog = page.locator("#help-dialog")
        assert dialog.evaluate("e => [e.scrollTop, e.scrollHeight > e.clientHeight]") == [0, True]
        assert page.locator("#help-title").evaluate("e => e === document.activeElement")


def test_on_a_telephone_the_bar_of_the_light_covers_nothing_of_the_result(
    opened: "Browser", server: Server
) -> None:
    with open_studio(opened, server.url, width=390, height=844) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        page = studio.page
        page.locator("#layout-both").click()
        page.locator("#view-lit").click()
        lamp, result = page.locator("#lamp").bounding_box(), page.locator("#viewer").bounding_box()
        assert lamp is not None
        assert result is not None
        assert lamp["y"] + lamp["height"] <= result["y"]
        assert result["height"] > 120


def test_on_a_telephone_a_finger_hits_every_control(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, width=390, height=844) as studio:
        studio.new()
        dent(studio)
        with studio.repainting():
            studio.pin(128, 128)
        page = studio.page
        small = page.evaluate(
            """() => [...document.querySelectorAll("button, summary, select, input")]
              .filter((each) => each.checkVisibility())
              .map((each) => [each.id || each.textContent, each.offsetWidth, each.offsetHeight])
              .filter(([, width, height]) => width < 44 || height < 44)"""
        )
        assert small == []
        for tool in ("pen", "eraser", "select", "mask", "brush", "light"):
            page.locator(f"#tool-{tool}").evaluate("each => each.click()")
            # A bar to scroll would take the room of the options' names.
            scrolls = page.evaluate(
                """() => [...document.querySelectorAll(".options")].filter((each) => each.checkVisibility())
                  .filter((each) => each.scrollWidth > each.clientWidth
                    || (each.scrollHeight > each.clientHeight && getComputedStyle(each).overflowY === "auto"))
                  .map((each) => each.id)"""
            )
            assert scrolls == [], tool
        page.locator("#tool-hint").click()
        card, pane = page.locator("#point").bounding_box(), page.locator("#board").bounding_box()
        assert card is not None
        assert pane is not None
        assert card["y"] >= pane["y"]
        assert card["y"] + card["height"] <= pane["y"] + pane["height"]
        assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_on_a_telephone_a_thumb_switches_between_two_full_canvases(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, width=390, height=844) as studio:
        page = studio.page
        assert page.locator("#samples").is_visible()  # whichever canvas is on show
        studio.new()
        dent(studio)
        switch = page.locator("#layout").bounding_box()
        assert switch is not None
        assert switch["y"] > 750
        for shown, name in (("#board", "drawing"), ("#viewer", "result")):
            page.locator(f"#layout-{name}").click()
            box = page.locator(shown).bounding_box()
            assert box is not None
            assert box["height"] > 500
        page.locator("#layers-toggle").click()
        page.locator("#layers-toggle").click()
        page.locator("#tools-toggle").click()
        page.locator("#tool-region").click()
        assert page.locator("#tool-region").is_hidden()
        page.locator("#menu-toggle").click()
        page.keyboard.press("Escape")
        assert page.locator("#help").is_hidden()
        assert page.evaluate("document.activeElement.id") == "menu-toggle"


def test_on_a_phone_all_of_two_lights_and_of_suggested_points_is_seen(
    opened: "Browser", server: Server
) -> None:
    with open_studio(opened, server.url, width=390, height=844) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()

        def hidden(options: str) -> int:
            found: int = page.evaluate(
                "(name) => { const { scrollWidth, clientWidth } = document.getElementById(name);"
                " return scrollWidth - clientWidth; }",
                options,
            )
            return found

        page.locator("#tool-hint").click()
        page.locator("#suggest").click()
        page.locator("#chips .offer").first.wait_for()
        assert hidden("hint-options") == hidden("chips") == 0
        page.locator("#layout button").last.click()
        page.locator("#view-lit").click()
        page.locator("#tools-toggle").click()
        page.locator("#tool-light").click()
        page.locator("#light-both").check()
        page.locator("#light-moves-2").wait_for()
        assert hidden("light-options") == 0


@pytest.mark.parametrize("width", [1024, 1280, 1680])
def test_beside_the_result_all_of_a_regions_form_is_seen(
    opened: "Browser", server: Server, width: int
) -> None:
    with open_studio(opened, server.url, width=width, height=800) as studio:
        studio.new()
        studio.page.keyboard.press("r")
        name = studio.page.locator("#form-choose span")
        assert name.evaluate("(e) => e.scrollWidth <= e.clientWidth")  # beside the help
        studio.circle()
        for _ in range(2):  # flat, whose name is the longest
            studio.page.keyboard.press("g")
        studio.wait_for_frame()
        assert studio.page.locator("#region-options").evaluate("(e) => e.scrollWidth <= e.clientWidth")


@pytest.mark.parametrize("locale", ["en-US", "de-DE"])
def test_choosing_a_structure_leaves_the_drawing_in_its_place(
    opened: "Browser", server: Server, locale: str
) -> None:
    with open_page(opened, width=1280, height=760, locale=locale) as page, sending_nothing_late(page):
        Studio(page, server.url)
        page.keyboard.press("d")
        before = page.locator("#board").bounding_box()
        page.keyboard.press("Shift+W")
        page.locator("#structure-choose").wait_for()
        assert page.locator("#board").bounding_box() == before
        assert page.locator("#brush-options").evaluate("(e) => e.scrollWidth <= e.clientWidth")


@pytest.mark.parametrize(("width", "height"), [(390, 780), (820, 1100)])
def test_narrow_windows_stack_the_panes(opened: "Browser", server: Server, width: int, height: int) -> None:
    with open_studio(opened, server.url, width=width, height=height) as studio:
        studio.new()
        dent(studio)
        studio.page.locator("#layout-both").click()
        drawing = studio.page.locator("#board").bounding_box()
        result = studio.page.locator("#viewer").bounding_box()
        assert drawing is not None
        assert result is not None
        assert drawing["y"] + drawing["height"] <= result["y"]
        assert min(drawing["height"], result["height"]) > 150
        assert studio.page.evaluate("document.documentElement.scrollWidth") <= width
        for control in ("#export", "#tool-hint", "#undo", "#view-relief"):
            box = studio.page.locator(control).bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width


@pytest.mark.parametrize("width", [568, 640, 719])  # 640 is 1280 at 200 %
def test_in_a_low_window_the_switch_of_the_canvases_covers_nothing(
    opened: "Browser", server: Server, width: int
) -> None:
    with open_page(opened, width=width, height=380, locale="es-ES") as page, sending_nothing_late(page):
        Studio(page, server.url)
        switch = page.locator("#layout").bounding_box()
        assert switch is not None
        for control in page.locator("header :is(button, summary, h1):visible").all():
            box = control.bounding_box()
            assert box is not None
            beside = box["x"] + box["width"] <= switch["x"] or box["x"] >= switch["x"] + switch["width"]
            assert beside, control.get_attribute("data-label")
            assert box["x"] + box["width"] <= width
        views = page.locator("#outcome > .bar")
        assert views.evaluate("(bar) => bar.scrollWidth <= bar.clientWidth")


@pytest.mark.parametrize(("width", "height"), [(667, 375), (1024, 600)])
def test_in_low_windows_the_panes_stay_side_by_side_and_every_tool_is_seen(
    opened: "Browser", server: Server, width: int, height: int
) -> None:
    with open_studio(opened, server.url, width=width, height=height) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        page = studio.page
        page.locator("#layout-both").click()
        drawing, result = (page.locator(each).bounding_box() for each in ("#board", "#viewer"))
        assert drawing is not None
        assert result is not None
        assert drawing["x"] + drawing["width"] <= result["x"]
        assert min(drawing["height"], result["height"]) > 240
        assert drawing["y"] + drawing["height"] <= height
        tools = page.locator("#tools > :not(.sheet):visible, #more-tools > :visible")
        assert tools.count() == 12
        for tool in tools.all():
            box = tool.bounding_box()
            assert box is not None
            assert box["y"] + box["height"] <= height
        for control in page.locator("header :is(button, summary, a, input, h1):visible").all():
            box = control.bounding_box()
            assert box is not None
            assert box["x"] + box["width"] <= width
        page.evaluate(
            "() => { document.querySelector('#status').textContent = 'It took a while. '.repeat(30); }"
        )
        assert page.locator("#viewer").bounding_box() == result  # a long status is cut off, and moves nothing
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_dark_and_light_follow_the_system_until_switched(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        header = studio.page.locator("header")

        def brightness() -> float:
            colour = header.evaluate("e => getComputedStyle(e).backgroundColor")
            return float(np.mean([int(part) for part in colour[4:-1].split(",")]))

        def follow(scheme: Literal["dark", "light"]) -> None:
            studio.page.emulate_media(color_scheme=scheme)
            # The page is told with its next picture, not at once.
            studio.page.wait_for_function(f"() => document.documentElement.dataset.theme === '{scheme}'")

        follow("dark")
        assert brightness() < 60
        follow("light")
        assert brightness() > 200
        studio.page.locator("#theme").click()
        assert brightness() < 60
        studio.page.reload()
        studio.page.wait_for_selector("html[data-ready]")
        assert brightness() < 60


def test_a_key_that_comes_just_after_a_dialog_has_closed_is_a_shortcut(studio: Studio) -> None:
    dent(studio)
    page = studio.page
    page.evaluate("document.activeElement.blur()")  # the dialog can give the focus back to nothing
    page.keyboard.press("Control+e")
    page.evaluate(
        """() => {
          document.getElementById("export-dialog").close();
          document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key: "2", bubbles: true }));
        }"""
    )
    assert page.locator("#result").get_attribute("data-view") == "lit"


@pytest.mark.parametrize("card", ["history", "paper"])
def test_escape_closes_a_card_and_the_keys_go_on_from_its_button(studio: Studio, card: str) -> None:
    summary = studio.page.locator(f"#{card} summary")
    summary.focus()
    studio.page.keyboard.press("Enter")
    assert studio.page.evaluate(f"document.getElementById('{card}').open")
    studio.page.keyboard.press("Escape")
    assert not studio.page.evaluate(f"document.getElementById('{card}').open")
    assert summary.evaluate("node => node === document.activeElement")
