"""Lines that are engraved or embossed on the studio's page: what they do to the map, wherever it goes."""

from pathlib import Path

import cv2
import pytest
from studio_page import SIDE, Studio
from test_page_export import export

# A server and a browser take seconds to start; every test begins with a circle, painted.
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("ball")]
MIDDLE = SIDE / 2


def lean(studio: Studio, x: float, y: float) -> float:
    """Return how much further up the map leans above a line than below it."""
    return float((studio.shown(x, y - 5) - studio.shown(x, y + 5))[1])


def test_a_line_is_engraved_or_embossed_and_its_erased_part_is_not(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    page.locator("#size").fill("8")  # 24 pixels
    carve = page.locator("#carve")
    assert page.locator("#carve-height").is_hidden()
    for y, label, sign in ((90, "Lines are engraved.", -1), (160, "Lines are embossed.", 1)):
        before = lean(studio, MIDDLE, y)
        page.keyboard.press("z")
        assert (carve.get_attribute("aria-label") or "").startswith(label)
        with studio.repainting():
            studio.line((90, y), (MIDDLE, y), (170, y))
        assert sign * (lean(studio, MIDDLE, y) - before) > 0.5
    page.keyboard.press("z")
    assert carve.get_attribute("aria-pressed") == "false"
    page.keyboard.press("e")
    before = lean(studio, 150, 160)
    with studio.repainting():
        studio.line((150, 130), (150, 190))
    assert lean(studio, 150, 160) < before - 0.5
    ridge = lean(studio, 110, 160)
    # A project, an export and the page show the same.
    studio.save_as("carved")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.keyboard.press("Control+o")
    with studio.repainting():
        page.locator(".project", has_text="carved").first.click()
    assert lean(studio, 110, 160) == pytest.approx(ridge, abs=0.05)
    for size, factor in ("", 1), ("512", 2):
        export(studio, tmp_path / "map.png", name="carved", what="map", size=size)
        file = cv2.imread(str(tmp_path / "map.png"), cv2.IMREAD_UNCHANGED)
        assert file is not None
        above, below = (int(file[round(y * factor), 110 * factor, 1]) for y in (155, 165))
        assert (above - below) / 127.5 == pytest.approx(ridge, abs=0.15)
    with studio.repainting():
        page.locator("#undo").click()  # the eraser
    with studio.repainting():
        page.locator("#undo").click()  # the ridge
    assert lean(studio, 110, 160) < ridge - 0.5


def test_no_piece_is_lost_of_lines_that_are_erased_into_hundreds(studio: Studio) -> None:
    page = studio.page
    page.locator("#size").fill("0")  # the thinnest
    page.keyboard.press("z")
    page.keyboard.press("z")
    with studio.repainting():
        for y in range(85, 160, 5):
            studio.line((70, y), (MIDDLE, y), (190, y))
    page.locator("#size").fill("8")
    with studio.repainting():
        studio.line((90, 178), (MIDDLE, 178), (170, 178))  # the last one
    ridge = lean(studio, MIDDLE, 178)
    page.keyboard.press("e")
    page.locator("#size").fill("2")  # 3 pixels
    with studio.repainting():
        for x in range(78, 187, 7):
            studio.line((x, 80), (x, 160))
    asked = page.evaluate(
        """async () => {
          const sent = new Promise((done) => {
            const { fetch } = window;
            window.fetch = (path, options) => {
              if (path === "/api/predict") done(options.body);
              return fetch(path, options);
            };
          });
          document.getElementById("undo").click();
          document.getElementById("redo").click();
          const body = await sent;
          const length = new DataView(body.buffer).getUint32(0, true);
          return JSON.parse(new TextDecoder().decode(body.subarray(4, 4 + length))).layers[0].areas.length;
        }"""
    )
    assert asked > 200
    assert lean(studio, MIDDLE, 178) == pytest.approx(ridge, abs=0.02)
