"""The studio's lasso: what a line is drawn around is chosen, also part of a picture, and becomes a layer."""

import base64
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from studio_page import SIDE, Studio

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
PAPER = (240, 230, 205)


def give(studio: Studio, picture: Image.Image, file: Path) -> None:
    """Import a picture as the drawing."""
    picture.save(file)
    with studio.repainting():
        studio.page.set_input_files("#import-file", files=file)
        studio.page.locator("#choose button[value=drawing]").click()


def two_circles(mode: str = "RGB", paper: tuple[int, ...] = PAPER) -> Image.Image:
    """Return two blue circles, and a line that joins them."""
    picture = Image.new(mode, (SIDE, SIDE), paper)
    draw = ImageDraw.Draw(picture)
    for x in (70, 190):
        draw.ellipse((x - 40, 88, x + 40, 168), outline=(20, 30, 120), width=5)
    draw.line((110, 128, 150, 128), fill=(20, 30, 120), width=5)
    return picture


def lasso(studio: Studio, x: float, y: float, radius: float) -> None:
    """Draw a lasso about a point."""
    angles = [2 * math.pi * i / 30 for i in range(31)]
    studio.line(*((x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles))


def saved(studio: Studio) -> list[dict[str, Any]]:
    """Save the project, and return its layers."""
    if studio.page.locator("#project-name").inner_text() == "Untitled":
        studio.save_as("lasso")
    else:
        with studio.saying("Saved"):
            studio.page.keyboard.press("Control+s")
    read = "fetch('/api/projects/lasso').then((answer) => answer.json())"
    return list(studio.page.evaluate(read)["layers"])


def pixels(stroke: dict[str, Any], paper: tuple[int, ...] = PAPER) -> NDArray[np.float64]:
    """Return a placed picture on a sheet of the drawing's size, on paper."""
    read = Image.open(io.BytesIO(base64.b64decode(stroke["picture"].split(",")[1]))).convert("RGBA")
    sheet = Image.new("RGBA", (SIDE, SIDE), (*paper, 255))
    sheet.alpha_composite(read, (round(stroke["x"]), round(stroke["y"])))
    return np.asarray(sheet.convert("RGB"), float)


def test_a_part_of_a_picture_becomes_a_layer_and_no_ink_is_lost_or_doubled(
    studio: Studio, tmp_path: Path
) -> None:
    page = studio.page
    give(studio, two_circles(), tmp_path / "circles.png")
    for x in (70, 190):
        studio.pin(x, 128)
        page.keyboard.press("Escape")
    page.keyboard.press("m")
    page.keyboard.press("x")
    studio.line((60, 150), (80, 150))
    page.keyboard.press("q")
    lasso(studio, 70, 128, 60)
    with studio.repainting(), studio.saying("Moved to “Layer 2”."):
        page.keyboard.press("j")
    rest, piece = saved(studio)
    left, right = pixels(rest["strokes"][0]), pixels(piece["strokes"][0])
    given = np.asarray(two_circles(), float)
    # On paper each shows its part, as it was, and paper elsewhere.
    away = np.abs(left - given).max(-1) > 3
    np.testing.assert_array_equal(left[away], np.broadcast_to(PAPER, left[away].shape))
    assert np.abs(right - given)[away].max() <= 2
    assert np.abs(right - PAPER)[~away].max() <= 3
    assert not away[:, 135:].any()
    assert (away[86:170, 28:112] == (np.abs(given - PAPER).max(-1) > 3)[86:170, 28:112]).all()
    assert [layer["hints"][0]["x"] for layer in (rest, piece)] == pytest.approx([190, 70], abs=2)
    assert [len(layer["mask"]) for layer in (rest, piece)] == [0, 1]
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list li").last.inner_text() == "Moved to a new layer"
    page.keyboard.press("Escape")
    with studio.repainting():
        page.keyboard.press("Control+z")  # one step
    (layer,) = saved(studio)
    np.testing.assert_array_equal(pixels(layer["strokes"][0]), given)
    assert len(layer["hints"]) == 2
    with studio.repainting():
        page.keyboard.press("Control+Shift+z")
    page.keyboard.press("p")
    with studio.repainting():
        studio.line((10, 10), (30, 10))  # after what was saved
    studio.wait_for_store(lambda kept: len(kept["doc"]["layers"][1]["strokes"]) == 2)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    studio.restored()
    assert len(saved(studio)) == 2


def test_a_cut_part_keeps_its_pixels_where_there_is_no_paper_and_is_dragged_and_erased(
    studio: Studio, tmp_path: Path
) -> None:
    page = studio.page
    give(studio, two_circles("RGBA", (0, 0, 0, 0)), tmp_path / "cutout.png")
    page.keyboard.press("e")
    with studio.repainting():
        studio.line((190, 80), (190, 95))  # a gap at the top of the right circle
    page.keyboard.press("q")
    lasso(studio, 190, 128, 58)
    with studio.repainting():
        studio.line((190, 128), (190, 140), (190, 168))  # taken inside the lasso, not on its ink
    (layer,) = saved(studio)
    pictures = [stroke for stroke in layer["strokes"] if stroke["kind"] == "picture"]
    left, right = (pixels(picture, (255, 255, 255)) for picture in pictures)
    given = np.asarray(two_circles(paper=(255, 255, 255)), float)
    np.testing.assert_array_equal(left[:, :112], given[:, :112])
    assert left[:, 150:].min() == 255
    assert right[120:136, 184:196].min() == 255  # the gap went along
    np.testing.assert_array_equal(right[150:216, 200:], given[110:176, 200:])
    lasso(studio, 70, 110, 30)  # across the other circle
    with studio.repainting():  # it is cut elsewhere
        page.keyboard.press("Delete")
    (layer,) = saved(studio)
    assert [stroke["kind"] for stroke in layer["strokes"]].count("picture") == 2
    page.locator("#history summary").click()
    page.locator("#history-list [aria-current]").wait_for()
    assert page.locator("#history-list li").all_inner_texts()[-2:] == ["Moved", "Lines deleted"]


def test_a_lasso_chooses_lines_that_lie_mostly_inside_and_says_where_nothing_does(studio: Studio) -> None:
    page = studio.page
    studio.circle(60, 60, 40)
    with studio.repainting():
        studio.circle(190, 60, 40)
    page.keyboard.press("e")
    with studio.repainting():
        studio.line((190, 90), (190, 110))  # of the right circle
    page.keyboard.press("q")
    with studio.saying("Nothing is drawn inside the lasso."):
        lasso(studio, 128, 200, 30)
    assert page.locator("#select-split").is_disabled()
    lasso(studio, 190, 55, 44)
    page.locator("#select-split").click()
    rest, new = saved(studio)
    assert [stroke["kind"] for stroke in rest["strokes"]] == ["pen", "eraser"]
    assert [stroke["kind"] for stroke in new["strokes"]] == ["pen", "eraser"]
    assert new["strokes"][0]["points"][0] == pytest.approx(230, abs=1)
    assert not studio.inked(190, 100)


def test_photographed_paper_is_filled_with_its_own_tone_and_grain(studio: Studio, tmp_path: Path) -> None:
    y, x = np.mgrid[:SIDE, :SIDE] / SIDE
    grain = np.random.default_rng(0).normal(0, 5, (SIDE, SIDE))
    bare = np.clip(np.dstack([235 - 60 * x - 20 * y, 225 - 60 * x, 200 - 50 * y]) + grain[..., None], 0, 255)
    picture = Image.fromarray(bare.astype(np.uint8))
    draw = ImageDraw.Draw(picture)
    for middle in (70, 190):
        draw.ellipse((middle - 40, 88, middle + 40, 168), outline=(40, 30, 50), width=7)
    give(studio, picture, tmp_path / "photo.png")
    studio.page.keyboard.press("q")
    lasso(studio, 190, 128, 56)
    with studio.repainting(), studio.saying("Moved to “Layer 2”."):
        studio.page.keyboard.press("j")
    rest, piece = (layer["strokes"][0] for layer in saved(studio))
    left, right = pixels(rest), pixels(piece, (255, 255, 255))
    gone = np.abs(bare - np.asarray(picture, float)).max(-1) > 60
    gone[:, :128] = False
    filled = (left - bare)[gone]
    assert np.abs(filled.mean(0)).max() < 1.5
    # Two grains that have nothing to do with each other differ by √2 of one's.
    assert 5 < filled.std(0).mean() < 9
    assert np.abs((left - np.asarray(picture, float))[:, :128]).max() == 0
    # No film of paper goes along.
    assert (right.min(-1)[112:144, 174:206] == 255).mean() > 0.97
    assert right[gone].max() < 90
