"""The first minute on the studio's page: samples, a sentence at a time, steps to go back to, lights."""

from typing import TYPE_CHECKING

import numpy as np
import pytest
from studio_page import SIDE, Server, open_studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start


def test_a_sample_is_taken_and_the_first_steps_follow(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        count = page.locator("#first-count")
        assert count.inner_text() == "1 / 4"
        with studio.repainting():
            page.locator("#samples button").nth(1).click()
        studio.size = 512, 512
        assert count.inner_text() == "2 / 4"
        assert page.locator("#samples").is_hidden()
        page.locator("#view-lit").click()
        assert count.inner_text() == "3 / 4"
        page.locator("#tool-hint").click()
        page.mouse.click(*studio.on_result(256, 300))
        with studio.repainting():
            studio.turn(0.4, 0.2)
        page.locator("#point-done").click()
        assert count.inner_text() == "4 / 4"
        page.reload()
        page.wait_for_selector("html[data-ready]")
        assert count.inner_text() == "4 / 4"
        page.locator("#first-skip").click()
        assert page.locator("#first-steps").is_hidden()
        page.reload()
        page.wait_for_selector("html[data-ready]")
        assert page.locator("#first-steps").is_hidden()


def test_first_steps_are_done_by_keys_and_in_any_order(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        count = page.locator("#first-count")
        with studio.repainting():
            page.locator("#samples button").first.click()
        page.keyboard.press("Control+e")
        page.locator("#export-dialog").wait_for()
        studio.dismiss("export")
        assert count.inner_text() == "2 / 4"
        page.keyboard.press("2")
        assert count.inner_text() == "3 / 4"
        studio.size = 512, 512
        studio.pin(256, 300)
        page.keyboard.press("Escape")
        page.locator("#first-steps").wait_for(state="hidden")


def test_the_history_is_a_list_that_outlives_a_reload(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        for y in (40, 80, 120):
            with studio.repainting():
                studio.line((40, y), (240, y))
        page.keyboard.press("e")
        with studio.repainting():
            studio.line((200, 20), (200, 140))
        rows = page.locator("#history-list button")
        page.locator("#history summary").click()
        rows.nth(4).wait_for()
        assert rows.all_inner_texts() == ["Beginning", "Line", "Line", "Line", "Erased"]
        rows.nth(2).click()
        assert studio.inked(225, 80)
        assert not studio.inked(225, 120)
        studio.wait_for_store(lambda kept: kept["history"]["at"] == 2)
        page.reload()
        page.wait_for_selector("html[data-ready]")
        studio.size = SIDE, SIDE
        studio.restored()
        page.locator("#history summary").click()
        rows.nth(4).wait_for()
        assert rows.all_inner_texts() == ["Beginning", "Line", "Line", "Line", "Erased"]
        assert rows.nth(2).get_attribute("aria-current") == "step"
        assert not studio.inked(225, 120)
        rows.nth(4).click()
        assert studio.inked(225, 120)
        assert not studio.inked(200, 80)
        page.locator("#undo").click()
        assert studio.inked(200, 80)
        for _ in range(3):
            page.locator("#undo").click()
        assert page.locator("#undo").is_disabled()


def test_lights_have_colours_and_go_around(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        page.locator("#view-lit").click()
        at = studio.on_result(SIDE / 2 + 50, SIDE / 2 + 20)

        def colour() -> list[int]:
            pixel: list[int] = studio.screen()[round(at[1]), round(at[0])].astype(int).tolist()
            return pixel

        white = colour()
        page.keyboard.press("l")
        page.locator("#light-both").check()
        page.locator("#light-2").fill("#ff2010")
        red = colour()
        assert (red[0] - red[2]) - (white[0] - white[2]) > 25
        page.mouse.click(*studio.on_result(SIDE / 2 - 70, SIDE / 2))  # moves the second light away
        moved = colour()
        assert red[0] - moved[0] > 10
        assert moved[0] - moved[2] < red[0] - red[2]
        page.locator("#light-both").uncheck()
        np.testing.assert_allclose(colour(), white, atol=3)
        page.locator("#light-play").click()
        assert page.locator("#light-play").get_attribute("aria-pressed") == "true"
        seen = set()

        def colours() -> int:
            seen.add(tuple(colour()))
            return len(seen)

        studio.until(colours, lambda count: count > 2)
        page.locator("#light-play").click()
        stood = colour()
        np.testing.assert_allclose(colour(), stood, atol=1)


@pytest.mark.parametrize("number", range(3))
def test_a_sample_is_drawn_so_that_nothing_is_to_be_warned_of(
    opened: "Browser", server: Server, number: int
) -> None:
    with open_studio(opened, server.url) as studio:
        with studio.repainting():
            studio.page.locator("#samples button").nth(number).click()
        assert studio.page.locator("#warning").inner_text() == ""
