"""Lights and materials of the lit result: colours, falloff, intensity, and the saved picture."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from studio_page import SIDE, Server, Studio, open_studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2


def colour(studio: Studio, x: float, y: float) -> NDArray[np.int64]:
    """Return what the result shows at a point of the drawing."""
    column, row = studio.on_result(x, y)
    pixel: NDArray[np.int64] = studio.screen()[round(row), round(column)].astype(np.int64)
    return pixel


def slide(studio: Studio, name: str, value: int) -> None:
    """Set a slider."""
    studio.page.locator(f"#light-{name}").fill(str(value))


def test_the_lit_result_has_the_drawings_colours_and_is_exported_as_it_is_seen(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        page.locator("#colour").fill("#d02010")
        page.locator("#size").fill("7")  # 16 pixels
        with studio.repainting():
            studio.circle()
        page.locator("#view-lit").click()
        line = MIDDLE + 80, MIDDLE
        clay = colour(studio, *line)
        page.locator("#material-colours").click()
        mine = colour(studio, *line)
        assert mine[0] - mine[2] > clay[0] - clay[2] + 40
        page.locator("#light-play").wait_for()
        with page.expect_download() as downloading:
            page.locator("#lit-save").click()
        assert downloading.value.suggested_filename == "untitled_lit.png"
        file = tmp_path / "lit.png"
        downloading.value.save_as(file)
        saved = np.asarray(Image.open(io.BytesIO(file.read_bytes())))
        assert saved.shape == (SIDE, SIDE, 4)
        assert np.abs(saved[int(line[1]), int(line[0]), :3].astype(int) - mine).max() < 30
        assert saved[2, 2, 3] == 0
        # It is in the dialog as well, at any size.
        page.locator("#export").click()
        page.locator("#export-what").select_option("lit")
        page.locator("#export-size").fill("128")
        with page.expect_download() as downloading:
            page.locator("#export-dialog button.strong").click()
        downloading.value.save_as(file)
        with Image.open(file) as smaller:
            assert smaller.size == (128, 128)
        page.locator("#material-clay").click()
        np.testing.assert_allclose(colour(studio, *line), clay, atol=2)


def test_a_light_has_height_intensity_and_falloff_which_are_kept(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        page.locator("#view-lit").click()
        page.locator("#lamp-more").click()
        near, far = (MIDDLE - 30, MIDDLE - 30), (MIDDLE + 45, MIDDLE + 45)
        slide(studio, "height", 60)
        before = colour(studio, *near).sum(), colour(studio, *far).sum()
        slide(studio, "falloff", 100)
        faded = colour(studio, *near).sum(), colour(studio, *far).sum()
        assert faded[1] / before[1] < 0.8 * faded[0] / before[0]
        slide(studio, "falloff", 0)
        slide(studio, "intensity", 30)
        assert colour(studio, *near).sum() < 0.8 * before[0]
        slide(studio, "height", 10)
        low = colour(studio, *far).sum()
        slide(studio, "height", 85)
        assert colour(studio, *far).sum() != low
        page.reload()
        page.wait_for_selector("html[data-ready]")
        assert page.locator("#light-intensity").input_value() == "30"
