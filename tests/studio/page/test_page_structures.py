"""The structure brush on the studio's page: scales and the like, and structures of one's own pictures."""

import base64

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from studio_page import SIDE, Hand, Studio

# A server and a browser take seconds to start; every test begins with a circle, painted.
pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("ball")]
MIDDLE = SIDE / 2


def result(studio: Studio) -> NDArray[np.int16]:
    """Return the map on show without its marks, as levels."""
    page = studio.page
    page.evaluate("document.getElementById('overlay').style.visibility = 'hidden'")
    (left, top), (right, bottom) = studio.on_result(0, 0), studio.on_result(SIDE, SIDE)
    shown = studio.screen()[round(top) : round(bottom), round(left) : round(right)]
    page.evaluate("document.getElementById('overlay').style.visibility = ''")
    return shown.astype(np.int16)


def differ(one: NDArray[np.int16], other: NDArray[np.int16]) -> float:
    """Return the mean difference of two maps, in levels."""
    return float(np.abs(one - other).mean())


def picture(kind: str) -> bytes:
    """Return a picture of upright ribs, which do not repeat, or of nothing."""
    x = np.arange(300) if kind == "ribs" else np.zeros(300)
    grey = np.rint(127 + 90 * np.sin(x / 5.3)).astype(np.uint8)
    return cv2.imencode(".png", np.broadcast_to(grey, (300, 300)))[1].tobytes()


def test_a_finger_paints_a_structure(studio: Studio) -> None:
    bare = result(studio)
    studio.page.keyboard.press("Shift+W")
    hand = Hand(studio)
    with studio.repainting():
        hand.put(studio.on_board(80, 120))
        for x in range(90, 190, 10):
            hand.move(studio.on_board(x, 122))
        hand.lift()
    assert differ(result(studio), bare) > 1


def test_a_structure_is_painted_changed_undone_saved_and_opened_again(studio: Studio) -> None:
    page = studio.page
    bare = result(studio)
    page.keyboard.press("Shift+W")
    assert page.locator("#brush-structure").get_attribute("aria-pressed") == "true"
    with studio.repainting():
        studio.line((80, 120), (180, 124))
    scales = result(studio)
    assert differ(scales, bare) > 1
    assert page.locator("#point").is_hidden()  # the next stroke may follow at once
    page.mouse.click(*studio.on_board(180, 124))  # its mark, as of other strokes: of two points the second
    with studio.repainting():
        page.keyboard.press("Shift+G")
    assert page.locator("#structure-choose").get_attribute("aria-label") == "Choose a structure: Fur"
    fur = result(studio)
    assert differ(fur, scales) > 1
    with studio.repainting():
        page.locator("#structure-turn").fill("90")
        page.locator("#structure-turn").dispatch_event("change")
    turned = result(studio)
    assert differ(turned, fur) > 1
    with studio.repainting():
        page.locator("#structure-period").fill("9")
        page.locator("#structure-period").dispatch_event("change")
    large = result(studio)
    assert differ(large, turned) > 1
    with studio.repainting():
        page.keyboard.press("Control+z")
    assert differ(result(studio), turned) < 0.1
    with studio.repainting():
        page.keyboard.press("Control+Shift+z")
    studio.save_as("pelt")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.wait_for_function("() => document.getElementById('result').ariaBusy === 'false'")
    assert differ(result(studio), large) < 0.1
    page.locator("#history summary").click()
    page.locator("#history-list li").first.wait_for()
    steps = page.locator("#history-list li").all_inner_texts()
    assert steps[-4:] == ["Structure", *["Brush stroke changed"] * 3]


def test_a_structure_moves_with_the_lines_that_it_lies_on(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("Shift+W")
    with studio.repainting():
        studio.line((90, 124), (160, 124))
    before = result(studio)
    page.keyboard.press("s")
    page.keyboard.press("Control+a")
    with studio.repainting():
        page.keyboard.press("Shift+ArrowRight")
    after = result(studio)
    shift = 0
    column = before[:, :, 2].astype(float)
    for step in range(1, 40):
        if (
            np.abs(after[:, step:, 2] - column[:, :-step]).mean()
            < np.abs(after[:, shift:, 2] - column[:, : column.shape[1] - shift]).mean()
        ):
            shift = step
    assert shift > 4
    # On a flatter picture of the ramp nothing else moves along: what differs is a level or two.
    part = np.s_[60:-60, 60 + shift : -60]
    still = np.s_[60:-60, 60 : -60 - shift]
    assert np.abs(after[part] - before[still]).mean() < 6
    assert np.abs(after[part] - before[part]).mean() > 2 * np.abs(after[part] - before[still]).mean()


@pytest.mark.parametrize("way", ["card", "keys"])
def test_a_structure_is_chosen_from_pictures(studio: Studio, way: str) -> None:
    page = studio.page
    page.keyboard.press("Shift+W")
    card = page.locator("#structure-card")
    assert card.is_hidden()
    if way == "card":
        page.locator("#structure-choose").click()
        card.locator("button", has_text="Stone").click()
    else:
        page.locator("#structure-choose").focus()
        page.keyboard.press("Enter")
        for _ in range(3):
            page.keyboard.press("ArrowRight")
        page.keyboard.press("Enter")
    assert card.is_hidden()
    assert page.evaluate("document.activeElement.id") == "structure-choose"
    assert page.locator("#structure-choose").get_attribute("aria-label") == "Choose a structure: Stone"
    page.keyboard.press("Enter")
    card.locator("canvas").nth(4).wait_for()
    page.wait_for_function(
        "() => [...document.querySelectorAll('#structure-card canvas')]"
        ".every((each) => each.toDataURL().length > 2000)"
    )
    page.keyboard.press("Escape")
    assert card.is_hidden()
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.keyboard.press("d")
    assert page.locator("#structure-choose").get_attribute("aria-label") == "Choose a structure: Stone"


def test_a_picture_becomes_a_structure_that_is_saved_with_the_drawing(studio: Studio) -> None:
    page = studio.page
    bare = result(studio)
    page.keyboard.press("Shift+W")
    with studio.saying("is uniform"):
        page.set_input_files(
            "#structure-file", {"name": "grey.png", "mimeType": "image/png", "buffer": picture("flat")}
        )
    page.set_input_files(
        "#structure-file", {"name": "ribs.png", "mimeType": "image/png", "buffer": picture("ribs")}
    )
    page.wait_for_function(
        "() => document.getElementById('structure-choose').ariaLabel.endsWith('Picture 1')"
    )
    with studio.repainting():
        studio.line((80, 110), (170, 110))
    with studio.repainting():
        studio.line((80, 140), (170, 140))
    ribbed = result(studio)
    across, upright = (np.abs(ribbed - bare)[..., channel].mean() for channel in (0, 1))
    assert across > 4 * upright  # upright ribs face left and right
    kept = studio.wait_for_store(lambda kept: len(kept["doc"]["layers"][0]["areas"]) == 2)
    assert len(kept["doc"]["structures"]) == 1  # of unsaved work too
    studio.save_as("ribs")
    saved = page.evaluate("fetch('/api/projects/ribs').then((answer) => answer.json())")
    assert len(saved["structures"]) == 1  # one for both strokes
    tile = cv2.imdecode(
        np.frombuffer(base64.b64decode(saved["structures"][0]["picture"].split(",")[1]), np.uint8), 0
    )
    assert tile is not None
    steps = np.abs(np.diff(tile.astype(int), axis=1, append=tile[:, :1]))
    assert steps[:, -1].mean() < 2 * steps.mean()  # no seam
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.wait_for_function("() => document.getElementById('result').ariaBusy === 'false'")
    assert differ(result(studio), ribbed) < 0.1


def test_a_copied_structure_takes_its_picture_to_another_drawing(studio: Studio) -> None:
    page = studio.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.keyboard.press("Shift+W")
    page.set_input_files(
        "#structure-file", {"name": "ribs.png", "mimeType": "image/png", "buffer": picture("ribs")}
    )
    page.wait_for_function(
        "() => document.getElementById('structure-choose').ariaLabel.endsWith('Picture 1')"
    )
    with studio.repainting():
        studio.line((80, 120), (170, 120))
    ribbed = result(studio)
    page.keyboard.press("s")
    page.keyboard.press("Control+a")
    with studio.saying("Copied."):
        page.keyboard.press("Control+c")
    studio.save_as("first")
    studio.new()
    with studio.repainting():
        page.keyboard.press("Control+v")
    assert differ(result(studio), ribbed) < 0.1
