"""The studio's page tells of a map in its own words, and shows on the drawing where that is."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image, ImageDraw
from studio_page import SIDE, Hand, Point, Server, Studio, sending_nothing_late

from chromium import page as open_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
OFF = (30.0, 40.0)
"""A place beside the circle."""


def ringed(studio: Studio, at: Point) -> bool:
    """Return whether there is something red about a point of the drawing."""
    column, row = (round(each) for each in studio.on_board(*at))
    red, green, blue = np.moveaxis(studio.screen()[row - 30 : row + 30, column - 30 : column + 30], -1, 0)
    return bool(((red > 180) & (green < 100) & (blue < 100)).sum() > 40)


@pytest.mark.parametrize(("width", "height"), [(390, 844), (844, 390), (1024, 768)])
def test_what_is_said_of_a_map_is_seen_whole_beside_layers(
    opened: "Browser", server: Server, width: int, height: int
) -> None:
    with open_page(opened, width=width, height=height) as page, sending_nothing_late(page):
        studio = Studio(page, server.url)
        studio.new()
        page.locator("#layout-both").click()
        with studio.repainting():
            studio.circle()
        with studio.repainting():
            studio.pin(*OFF)
        page.keyboard.press("Escape")
        page.locator("#layers-toggle").click()
        for layout in ("drawing", "result", "both"):
            page.locator(f"#layout-{layout}").click()
            page.mouse.move(2, 2)
            studio.wait_for_frame()
            seen = page.locator("#warning button").evaluate(
                """(said) => {
                  const { left, right, top, bottom } = said.getBoundingClientRect();
                  const corners = [[left + 1, top + 1], [right - 1, bottom - 1], [left + 1, bottom - 1]];
                  const there = ([x, y]) => said.parentElement.contains(document.elementFromPoint(x, y));
                  return corners.every(there);
                }"""
            )
            assert seen, layout


@pytest.mark.parametrize("size", [(390, 844), (1280, 760)])
def test_a_toast_covers_no_finding(opened: "Browser", server: Server, size: tuple[int, int]) -> None:
    with open_page(opened, width=size[0], height=size[1]) as page, sending_nothing_late(page):
        studio = Studio(page, server.url)
        studio.new()
        page.locator("#layout-both").click()
        with studio.repainting():
            studio.circle()
        if page.locator("#menu-toggle").is_visible():
            page.locator("#menu-toggle").click()
        page.locator("#new").click()
        page.locator("#choose button[value=drop]").click()
        page.locator("#new-dialog button.strong").click()
        page.locator("#toast").wait_for()
        studio.wait_for_frame()
        studio.size = 512, 512
        with studio.repainting():
            studio.line((200, 200), (320, 200), (320, 330), (200, 330), (200, 200))
        with studio.repainting():
            studio.pin(40, 40)
        page.keyboard.press("Escape")
        toast, said = (page.locator(each).bounding_box() for each in ("#toast", "#warning"))
        assert toast is not None
        assert said is not None
        assert said["y"] + said["height"] <= toast["y"]
        tools = page.locator("#tools").bounding_box()
        assert tools is not None
        assert toast["x"] >= tools["x"] + tools["width"] or toast["y"] + toast["height"] <= tools["y"]


def test_a_point_off_the_object_is_told_in_the_pages_language_and_shown(
    opened: "Browser", server: Server
) -> None:
    with open_page(opened, width=1200, height=700, locale="de-DE") as page, sending_nothing_late(page):
        studio = Studio(page, server.url)
        studio.new()
        with studio.repainting():
            studio.circle()
        with studio.repainting():
            studio.pin(*OFF)
        page.keyboard.press("Escape")
        said = page.locator("#warning button")
        assert said.inner_text() == "Ein Punkt liegt neben dem Objekt. Zieh ihn zurück."
        assert not ringed(studio, OFF)
        said.hover()
        studio.until(lambda: ringed(studio, OFF))
        page.mouse.move(2, 2)
        studio.until(lambda: not ringed(studio, OFF))
        # A finger cannot hover; what it has pressed stays on show for a while.
        box = said.bounding_box()
        assert box is not None
        hand = Hand(studio)
        hand.put((box["x"] + 20, box["y"] + box["height"] / 2))
        hand.lift()
        studio.until(lambda: ringed(studio, OFF))
        with studio.repainting():
            page.keyboard.press("Control+z")
        assert page.locator("#warning").is_hidden()
        assert not ringed(studio, OFF)


def test_separate_figures_are_told_until_each_has_its_own_layer(opened: "Browser", server: Server) -> None:
    with open_page(opened, width=1200, height=700) as page, sending_nothing_late(page):
        studio = Studio(page, server.url)
        studio.new()
        studio.circle(70, 128, 45)
        with studio.repainting():
            studio.circle(190, 128, 45)
        said = page.locator("#warning button", has_text="This shows 2 separate figures")
        assert said.is_visible()
        said.hover()
        studio.until(lambda: ringed(studio, (190, 128)))
        page.keyboard.press("q")
        studio.line((135, 60), (245, 60), (245, 196), (135, 196), (135, 60))
        with studio.repainting():
            page.keyboard.press("j")
        assert said.count() == 0


def test_separate_figures_are_given_a_layer_each_by_one_click(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    picture = Image.new("RGB", (SIDE, SIDE), (240, 230, 205))
    draw = ImageDraw.Draw(picture)
    for x, y in ((60, 64), (190, 64), (128, 190)):
        draw.ellipse((x - 42, y - 42, x + 42, y + 42), outline=(20, 30, 120), width=5)
    picture.save(tmp_path / "page.png")
    with studio.repainting():
        page.set_input_files("#import-file", files=tmp_path / "page.png")
        page.locator("#choose button[value=drawing]").click()
    for x, y in ((60, 64), (128, 190)):
        with studio.repainting():
            studio.pin(x, y)
        page.keyboard.press("Escape")
    with studio.repainting(), studio.saying("Each figure has its own layer now."):
        page.locator("#warning .way").click()
    assert page.locator("#warning").is_hidden()
    kept = studio.wait_for_server(lambda doc: len(doc["layers"]) == 3)["layers"]
    assert [layer["name"] for layer in kept] == ["Layer 1", "Layer 2", "Layer 3"]
    assert [[round(hint["y"]) for hint in layer["hints"]] for layer in kept] == [[64], [], [190]]
    parts = [layer["strokes"][0] for layer in kept[1:]]
    centres = [(part["x"] + part["width"] / 2, part["y"] + part["height"] / 2) for part in parts]
    assert centres == [pytest.approx((190, 64), abs=1), pytest.approx((128, 190), abs=1)]
    with studio.repainting():
        page.keyboard.press("Control+z")  # one step
    assert page.locator("#warning .way").is_visible()
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list li").all_inner_texts()[1:] == [
        "Picture imported",
        "Point",
        "Point",
        "Moved to a new layer",
    ]


def test_more_figures_than_layers_are_to_be_circled_by_hand(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    picture = Image.new("RGB", (640, 512), "white")
    draw = ImageDraw.Draw(picture)
    for x in range(64, 640, 128):
        for y in range(64, 512, 128):
            draw.ellipse((x - 42, y - 42, x + 42, y + 42), outline="black", width=5)
    picture.save(tmp_path / "page.png")
    with studio.repainting():
        page.set_input_files("#import-file", files=tmp_path / "page.png")
        page.locator("#choose button[value=drawing]").click()
    said = page.locator("#warning")
    assert "20 separate figures" in said.inner_text()
    assert "Circle each with the lasso" in said.inner_text()
    assert page.locator("#warning .way").count() == 0
