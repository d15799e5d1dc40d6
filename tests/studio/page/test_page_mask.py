"""The mask brush on the studio's page: it adds to the object, cuts from it, and closes open outlines."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from studio_page import RADIUS, SIDE, Server, Studio, open_studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2


def is_object(studio: Studio, x: float, y: float) -> bool:
    """Return whether the result shows the object at a point of the drawing, and not the board behind it."""
    return bool(np.ptp(studio.shown(x, y)) > 0.2)


def test_the_brush_adds_and_cuts_and_that_is_undone(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        beyond, within = (MIDDLE + 98, MIDDLE), (MIDDLE - 40, MIDDLE - 30)
        assert not is_object(studio, *beyond)
        page.keyboard.press("m")
        page.keyboard.press("x")  # the brush
        with studio.repainting():
            studio.line((MIDDLE + 80, MIDDLE), beyond)
        assert is_object(studio, *beyond)
        page.keyboard.press("x")
        assert page.locator("#mask-cut").get_attribute("aria-pressed") == "true"
        with studio.repainting():
            studio.line(within, (MIDDLE - 36, MIDDLE - 30))
        assert not is_object(studio, *within)
        assert is_object(studio, *beyond)
        page.mouse.move(2, 2)
        column, row = map(round, studio.on_board(MIDDLE + 40, MIDDLE + 30))
        tint = studio.screen()[row, column].astype(int)
        assert tint[2] - tint[0] > 15  # the object is tinted while its mask is painted
        with studio.repainting():
            page.keyboard.press("Control+z")
        assert is_object(studio, *within)
        with studio.repainting():
            page.locator("#mask-clear").click()
        assert not is_object(studio, *beyond)


def test_an_open_outline_keeps_its_object_and_is_settled_by_a_dab(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        inside = [(MIDDLE + x, MIDDLE + y) for x, y in ((0, 0), (60, 10), (-60, 0), (0, -60), (0, 60))]
        page.keyboard.press("e")
        with studio.repainting():
            studio.line((MIDDLE + 80, MIDDLE - 14), (MIDDLE + 80, MIDDLE + 14))
        assert all(is_object(studio, *point) for point in inside)
        page.keyboard.press("p")
        ear = [(MIDDLE + 80 * math.cos(a), MIDDLE + 80 * math.sin(a)) for a in (-1.9, -1.2)]
        with studio.repainting():
            studio.line(ear[0], (MIDDLE - 10, 30), (MIDDLE + 10, 24))  # half of an ear
        assert all(is_object(studio, *point) for point in inside)
        page.keyboard.press("m")
        page.keyboard.press("x")  # the brush
        with studio.repainting():
            studio.line((MIDDLE + 80, MIDDLE - 14), (MIDDLE + 80, MIDDLE + 14))
        assert page.locator("#warning").is_hidden()
        assert all(is_object(studio, *point) for point in inside)


def test_a_click_makes_an_area_a_hole_and_object_again(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        with studio.repainting():
            studio.circle(radius=30)
        before = is_object(studio, MIDDLE, MIDDLE)  # hole or object, as the reader sees it
        page.keyboard.press("a")
        assert page.locator("#mask-area").get_attribute("aria-pressed") == "true"
        column, row = map(round, studio.on_board(MIDDLE, MIDDLE))
        plain = studio.screen()[row, column].astype(int)
        page.mouse.move(column, row)
        assert studio.screen()[row, column].astype(int).sum() < plain.sum() - 60  # what a click would change
        with studio.repainting():
            page.mouse.click(column, row)
        assert is_object(studio, MIDDLE, MIDDLE) is not before
        assert is_object(studio, MIDDLE + 20, MIDDLE) is not before
        assert is_object(studio, MIDDLE + 55, MIDDLE)
        stored = studio.wait_for_store(lambda each: bool(each["doc"]["layers"][0]["mask"]))
        assert stored["doc"]["layers"][0]["mask"][0]["fills"] is True
        with studio.repainting():
            page.mouse.click(column, row)
        assert is_object(studio, MIDDLE, MIDDLE) is before
        for wanted in (not before, before):
            with studio.repainting():
                page.keyboard.press("Control+z")
            assert is_object(studio, MIDDLE, MIDDLE) is wanted
        with studio.saying("open to the paper's edge"):
            page.mouse.click(*studio.on_board(8, 8))
        assert page.locator("#mask-clear").is_disabled()


def test_areas_and_points_of_a_photo_are_found_on_dark_paper(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    photo = np.full((SIDE, SIDE, 3), (128, 136, 140), np.uint8)
    middle = SIDE // 2, SIDE // 2
    for radius in (RADIUS, 30):
        cv2.circle(photo, middle, radius, (90, 40, 50), 5, cv2.LINE_AA)
    cv2.imwrite(str(tmp_path / "photo.png"), photo)
    with open_studio(opened, server.url) as studio:
        page = studio.page
        page.set_input_files("#import-file", files=tmp_path / "photo.png")
        with studio.repainting():
            page.locator("#choose button[value=drawing]").click()
        studio.size = SIDE, SIDE
        before = is_object(studio, MIDDLE, MIDDLE)
        page.keyboard.press("m")
        with studio.repainting():
            page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
        assert is_object(studio, MIDDLE, MIDDLE) is not before
        assert is_object(studio, MIDDLE + 20, MIDDLE) is not before
        assert is_object(studio, MIDDLE + 55, MIDDLE)
        page.locator("#layers-toggle").click()
        page.locator("#layer-add").click()
        studio.pin(MIDDLE + 55, MIDDLE)  # on the object, and so in the photo's layer
        stored = studio.wait_for_store(lambda each: any(layer["hints"] for layer in each["doc"]["layers"]))
        assert [len(layer["hints"]) for layer in stored["doc"]["layers"]] == [1, 0]
        page.locator("#point-done").click()
        page.locator("#layer-list li").first.click()
        studio.pin(8, 8)  # no line encloses it, but the new layer has none at all
        stored = studio.wait_for_store(lambda each: len(each["doc"]["layers"][0]["hints"]) == 2)
        assert not stored["doc"]["layers"][1]["hints"]


def light_lines() -> tuple[NDArray[np.uint8], tuple[float, float]]:
    """A circle in light lines on a grey board, and a point in it."""
    board = np.full((SIDE, SIDE), 115, np.uint8)
    cv2.circle(board, (SIDE // 2, SIDE // 2), RADIUS, (240,), 5, cv2.LINE_AA)
    return board, (MIDDLE, MIDDLE)


def in_a_shadow() -> tuple[NDArray[np.uint8], tuple[float, float]]:
    """A circle in dark lines on paper half of which lies in a shadow, and a point in circle and shadow."""
    paper = np.full((SIDE, SIDE), 220, np.uint8)
    cv2.circle(paper, (SIDE // 2, SIDE // 2), RADIUS, (50,), 5, cv2.LINE_AA)
    shade = np.where(np.arange(SIDE) > MIDDLE + 20, 0.4, 1.0)
    return np.rint(paper * shade).astype(np.uint8), (MIDDLE + 50, MIDDLE)


@pytest.mark.parametrize("drawn", [light_lines, in_a_shadow])
def test_areas_are_found_by_light_lines_and_in_a_shadow(
    studio: Studio, tmp_path: Path, drawn: Callable[[], tuple[NDArray[np.uint8], tuple[float, float]]]
) -> None:
    picture, inside = drawn()
    cv2.imwrite(str(tmp_path / "photo.png"), picture)
    page = studio.page
    page.set_input_files("#import-file", files=tmp_path / "photo.png")
    with studio.repainting():
        page.locator("#choose button[value=drawing]").click()
    page.keyboard.press("m")
    column, row = map(round, studio.on_board(*inside))
    plain = studio.screen()[row, column].astype(int)
    page.mouse.move(column, row)
    assert np.abs(studio.screen()[row, column] - plain).max() > 20  # what a click would change
    with studio.saying("The area is "):
        page.mouse.click(column, row)
