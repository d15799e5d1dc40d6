"""The studio's tools: lines are selected, moved, scaled, mirrored, coloured; the paper is resized."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from PIL import Image
from studio_page import SIDE, Studio

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2


def box_of_ink(studio: Studio) -> tuple[float, float, float, float]:
    """Return left, top, right and bottom of the dark pixels, in pixels of the drawing."""
    studio.page.mouse.move(2, 2)
    (left, top), (right, bottom) = studio.on_board(0, 0), studio.on_board(SIDE, SIDE)
    picture = studio.screen()[round(top) : round(bottom), round(left) : round(right)].max(-1) < 110
    rows, columns = np.nonzero(picture)
    scale = (right - left) / SIDE
    return (columns.min() / scale, rows.min() / scale, (columns.max() + 1) / scale, (rows.max() + 1) / scale)


def test_lines_are_selected_moved_scaled_and_removed(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((40, 40), (80, 40), (80, 80), (40, 80), (40, 40))
    before = np.array(box_of_ink(studio))
    page.keyboard.press("s")
    studio.line((79, 60), (110, 70), (139, 90))  # dragged by its right side
    page.locator("#select-remove").wait_for()
    assert page.locator("#select-remove").is_enabled()
    page.keyboard.press("Escape")
    moved = np.array(box_of_ink(studio))
    np.testing.assert_allclose(moved - before, [60, 30, 60, 30], atol=2)
    page.mouse.click(*studio.on_board(140, 90))
    left, top, right, bottom = moved
    studio.line((right, bottom), (right + 20, bottom + 20), (2 * right - left, 2 * bottom - top))
    page.keyboard.press("Escape")
    scaled = np.array(box_of_ink(studio))
    np.testing.assert_allclose(scaled[:2], moved[:2], atol=3)
    np.testing.assert_allclose((scaled[2:] - scaled[:2]) / (moved[2:] - moved[:2]), 2, atol=0.12)
    page.keyboard.press("Control+z")
    np.testing.assert_allclose(box_of_ink(studio), moved, atol=1)  # one step for one drag
    studio.line((20, 20), (250, 250))  # drawn around: all that is inside
    page.keyboard.press("Delete")
    page.wait_for_function("() => !document.getElementById('empty-result').hidden")
    page.keyboard.press("Control+z")
    np.testing.assert_allclose(box_of_ink(studio), moved, atol=1)


def test_straight_and_mirrored_lines_and_their_colour(studio: Studio) -> None:
    page = studio.page
    page.keyboard.down("Shift")
    studio.line((30, 60), (60, 100), (110, 62))
    page.keyboard.up("Shift")
    assert studio.inked(70, 60)  # nearly level is level
    assert not studio.inked(60, 90)
    page.locator("#symmetry").click()
    page.locator("#colour").fill("#2040c0")
    with studio.repainting():
        studio.line((30, 150), (30, 200), (90, 200))
    page.mouse.move(2, 2)
    for x, y in ((30, 180), (SIDE - 30, 180), (SIDE - 70, 200)):
        column, row = map(round, studio.on_board(x, y))
        np.testing.assert_allclose(studio.screen()[row, column], [0x20, 0x40, 0xC0], atol=6)
    page.keyboard.press("Control+z")
    column, row = map(round, studio.on_board(SIDE - 30, 180))
    assert studio.screen()[row, column].min() > 250  # both go at once


def test_a_pens_other_end_erases_and_brushes_are_remembered(studio: Studio) -> None:
    page = studio.page
    studio.line((40, 60), (200, 60))
    assert studio.inked(120, 60)
    page.locator("#size").fill("9")
    page.locator("#smoothing").fill("70")
    erase = """([from, to]) => {
      const board = document.getElementById("board");
      board.setPointerCapture = () => {};
      const send = (type, [x, y], buttons) => board.dispatchEvent(new PointerEvent(type, { pointerId: 7,
        pointerType: "pen", pressure: 0.5, clientX: x, clientY: y, button: 5, buttons, bubbles: true }));
      send("pointerdown", from, 32);
      send("pointermove", to, 32);
      send("pointerup", to, 0);
    }"""
    page.evaluate(erase, [studio.on_board(120, 40), studio.on_board(120, 80)])
    assert not studio.inked(120, 60)
    assert studio.inked(60, 60)
    assert page.locator("#tool-pen").get_attribute("aria-pressed") == "true"
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert page.locator("#size").input_value() == "9"
    assert page.locator("#smoothing").input_value() == "70"


def test_the_paper_is_resized_with_what_is_on_it_or_without(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((100, 100), (150, 100), (150, 150), (100, 150), (100, 100))

    def resize(width: int, height: int, *, along: bool) -> None:
        page.locator("#paper summary").click()
        page.locator("#paper-resize").click()
        page.locator("#paper-width").fill(str(width))
        page.locator("#paper-height").fill(str(height))
        page.locator("#paper-along").set_checked(along)
        with studio.answering("paper-dialog"):
            page.locator("#paper-dialog button.strong").click()
        page.locator("#paper summary").click()
        studio.size = width, height

    resize(512, 512, along=True)
    assert page.locator("#pixels").inner_text() == "512 × 512"
    assert studio.inked(200, 250)
    resize(612, 512, along=False)
    assert studio.inked(250, 250)
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    studio.size = SIDE, SIDE
    assert studio.inked(100, 125)


def test_the_paper_is_trimmed_to_what_is_drawn(studio: Studio) -> None:
    page = studio.page
    page.locator("#paper summary").click()
    with studio.saying("Nothing is drawn"):
        page.locator("#paper-trim").click()
    page.locator("#paper summary").click()
    with studio.repainting():
        studio.line((60, 100), (120, 100), (120, 150), (60, 150), (60, 100))
    studio.line((180, 40), (200, 40))
    page.keyboard.press("e")
    studio.line((160, 40), (220, 40))  # what is erased is not drawn
    page.locator("#paper summary").click()
    with studio.repainting():
        page.locator("#paper-trim").click()
    page.locator("#paper summary").click()
    width, height = (int(side) for side in page.locator("#pixels").inner_text().split(" × "))
    assert 64 <= width <= 70
    assert 54 <= height <= 60
    studio.size = width, height
    assert studio.inked(3, height / 2)
    assert not studio.inked(width / 2, height / 2)
    page.keyboard.press("Control+z")
    studio.size = SIDE, SIDE
    assert studio.inked(60, 125)


def test_photographed_paper_is_trimmed_to_its_lines(studio: Studio, tmp_path: Path) -> None:
    photo = np.rint(np.linspace(120, 200, SIDE * SIDE)).astype(np.uint8).reshape(SIDE, SIDE)
    cv2.circle(photo, (100, 120), 40, (60,), 5)
    cv2.imwrite(str(tmp_path / "photo.png"), photo)
    page = studio.page
    page.set_input_files("#import-file", files=tmp_path / "photo.png")
    with studio.repainting():
        page.locator("#choose button[value=drawing]").click()
    page.locator("#paper summary").click()
    with studio.repainting():
        page.locator("#paper-trim").click()
    width, height = (int(side) for side in page.locator("#pixels").inner_text().split(" × "))
    assert 86 <= width <= 105
    assert 86 <= height <= 105
    with studio.saying("The paper already fits"):
        page.locator("#paper-trim").click()


def test_paper_that_is_trimmed_to_a_dot_is_as_large_as_a_drawing_must_be(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((60, 100), (62, 100))
    page.locator("#paper summary").click()
    page.locator("#paper-trim").click()
    assert page.locator("#pixels").inner_text() == "16 × 16"


def test_a_picture_to_look_at_is_placed_beside_the_paper(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((100, 100), (150, 100))
    before = studio.predicted()
    for name, colour in (("red", (220, 40, 40)), ("green", (40, 160, 60))):
        Image.new("RGB", (64, 64), colour).save(tmp_path / f"{name}.png")
        with studio.saying(name):
            page.set_input_files("#import-file", files=tmp_path / f"{name}.png")
            page.locator("#choose button[value=traced]").click()
    page.locator("#paper summary").click()
    assert page.locator("#picture-list li").count() == 2
    page.locator("#picture-list input[type=range]").nth(1).fill("100")
    page.locator("#paper summary").click()
    page.keyboard.press("s")
    studio.line((128, 200), (60, 200), (-100, 200))  # beyond the paper's edge
    page.mouse.move(2, 2)
    page.keyboard.press("Escape")
    column, row = map(round, studio.on_board(-8, 200))
    np.testing.assert_allclose(studio.screen()[row, column], [40, 160, 60], atol=8)
    assert studio.predicted() == before  # what is looked at is never painted from


def layer_after(studio: Studio, steps: int) -> dict[str, Any]:
    """Return the only layer, or the hindmost, once the browser has kept so many steps."""
    kept = studio.wait_for_store(lambda kept: kept["history"]["at"] == steps)
    return dict(kept["doc"]["layers"][0])


def moves(before: list[dict[str, Any]], after: list[dict[str, Any]]) -> list[tuple[int, int]]:
    """Return how far each mark was moved."""
    places = [
        [mark["points"][:2] if "points" in mark else [mark["x"], mark["y"]] for mark in marks]
        for marks in (before, after)
    ]
    return [(round(x - a), round(y - b)) for (a, b), (x, y) in zip(*places, strict=True)]


def test_points_regions_mask_and_what_was_erased_move_with_the_lines_around_them(studio: Studio) -> None:
    page = studio.page
    studio.circle(60, 60, 40)
    studio.line((150, 40), (230, 40), (230, 110), (150, 110), (150, 40))
    page.keyboard.press("e")
    studio.line((60, 95), (60, 105))  # a gap in the circle
    assert not studio.inked(60, 100)
    for x, y in ((60, 60), (190, 75)):
        studio.pin(x, y)
        page.keyboard.press("Escape")
    page.keyboard.press("r")
    studio.line((40, 40), (55, 40), (55, 55), (40, 55), (40, 41))
    page.keyboard.press("m")
    page.keyboard.press("x")  # the brush
    studio.line((50, 70), (70, 70))
    page.keyboard.press("s")

    before = layer_after(studio, 7)
    with studio.repainting():
        studio.line((20, 60), (60, 80), (120, 160))  # the circle, by its left side
    after = layer_after(studio, 8)
    assert moves(before["hints"], after["hints"]) == [(100, 100), (0, 0)]
    assert moves(before["areas"], after["areas"]) == [(100, 100)]
    assert moves(before["mask"], after["mask"]) == [(100, 100)]
    assert not studio.inked(160, 200)  # the gap went along
    assert studio.inked(160, 120)
    page.keyboard.press("Control+a")
    with studio.repainting():
        studio.line((200, 160), (200, 150), (190, 130))  # all of the layer
    assert moves(after["hints"], layer_after(studio, 9)["hints"]) == [(-10, -30), (-10, -30)]


def test_a_selection_is_dragged_by_its_frame_and_a_click_there_deselects(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle(80, 80, 50)
    page.keyboard.press("s")
    page.mouse.click(*studio.on_board(30, 80))
    with studio.repainting():
        studio.line((80, 80), (100, 90), (140, 130))  # from its middle, where nothing is drawn
    assert studio.inked(90, 130)
    assert not studio.inked(30, 80)
    page.mouse.click(*studio.on_board(140, 130))
    assert page.locator("#select-remove").is_disabled()


def test_a_selection_is_flipped_turned_nudged_and_its_points_turn_with_it(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.line((40, 40), (100, 40), (100, 70), (40, 70), (40, 41))
    studio.pin(50, 60)
    with studio.repainting():
        studio.turn(0.6, 0)
    page.keyboard.press("Escape")
    steps = 3  # the line, the point, its direction
    page.keyboard.press("Control+a")
    page.locator("#select-flip").click()
    hint = layer_after(studio, steps + 1)["hints"][0]
    assert (hint["x"], hint["y"]) == pytest.approx((90.5, 60.5), abs=4)
    assert hint["normal"] == pytest.approx([-0.6, 0, 0.8], abs=0.06)
    page.locator("#select-turn").click()  # clockwise: what leans to the left leans upwards
    hint = layer_after(studio, steps + 2)["hints"][0]
    assert hint["normal"] == pytest.approx([0, 0.6, 0.8], abs=0.06)
    left, top, right, bottom = box_of_ink(studio)
    assert bottom - top == pytest.approx(66, abs=6)
    assert right - left == pytest.approx(36, abs=6)
    page.locator("#board").focus()
    for _ in range(3):
        page.keyboard.press("Shift+ArrowRight")
        page.evaluate("() => { const now = performance.now(); performance.now = () => now + 5000; }")
    assert box_of_ink(studio)[0] == pytest.approx(left + 30, abs=1)
    assert len(layer_after(studio, steps + 3)["hints"]) == 1  # three presses are one step, however slow


def test_a_selection_is_turned_by_its_knob(studio: Studio) -> None:
    with studio.repainting():
        studio.line((80, 120), (180, 120))
    studio.page.keyboard.press("Control+a")
    scale = studio.on_board(1, 0)[0] - studio.on_board(0, 0)[0]
    knob = studio.on_board(130, 117 - 26 / scale)
    studio.page.mouse.move(*knob)
    studio.page.mouse.down()
    studio.page.mouse.move(*studio.on_board(150, 118))
    studio.page.mouse.move(*studio.on_board(190, 120))  # a quarter turn
    studio.page.mouse.up()
    left, top, right, bottom = box_of_ink(studio)
    assert bottom - top == pytest.approx(102, abs=7)
    assert right - left < 12


def test_a_mirrored_line_is_turned_as_two(studio: Studio) -> None:
    studio.page.locator("#symmetry").click()
    with studio.repainting():
        studio.line((40, 60), (70, 60))
    studio.page.locator("#symmetry").click()
    studio.page.keyboard.press("Control+a")
    studio.page.locator("#select-turn").click()
    assert len(layer_after(studio, 2)["strokes"]) == 2
    left, _, right, bottom = box_of_ink(studio)
    assert right - left < 12
    assert bottom == pytest.approx(148, abs=5)


def test_lines_are_duplicated_copied_and_brought_to_another_layer(studio: Studio) -> None:
    page = studio.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    with studio.repainting():
        studio.line((40, 40), (80, 40), (80, 80), (40, 80), (40, 41))
    page.keyboard.press("Control+a")
    page.keyboard.press("Control+d")
    assert studio.inked(92, 70)
    assert len(layer_after(studio, 2)["strokes"]) == 2
    page.locator("#board").focus()
    page.keyboard.press("Control+x")  # the copy, which is selected
    assert not studio.inked(92, 70)
    page.keyboard.press("Control+v")
    studio.page.wait_for_function("() => !document.getElementById('select-copy').disabled")
    assert len(layer_after(studio, 4)["strokes"]) == 2
    with studio.saying("Moved to “Layer 2”."):
        page.locator("#select-layer").select_option("new")
    kept = studio.wait_for_store(lambda kept: kept["history"]["at"] == 5)
    assert [len(layer["strokes"]) for layer in kept["doc"]["layers"]] == [1, 1]
    page.keyboard.press("Control+z")
    assert len(layer_after(studio, 4)["strokes"]) == 2


def test_an_imported_picture_is_turned(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    pixels = np.full((64, 64, 3), 255, np.uint8)
    pixels[:, :16] = (220, 40, 40)  # its left is red
    Image.fromarray(pixels).save(tmp_path / "red.png")
    studio.line((10, 10), (20, 10))
    with studio.saying("red"):
        page.set_input_files("#import-file", files=tmp_path / "red.png")
        page.locator("#choose button[value=traced]").click()
    page.locator("#paper summary").click()
    page.locator("#picture-list input[type=range]").fill("100")
    page.locator("#paper summary").click()
    page.keyboard.press("s")
    page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
    page.locator("#select-turn").click()
    page.keyboard.press("Escape")
    page.mouse.move(2, 2)
    for (x, y), red in (((MIDDLE, 20), True), ((20, MIDDLE + 60), False)):
        column, row = map(round, studio.on_board(x, y))
        assert (studio.screen()[row, column][1] < 100) == red


def test_a_click_fills_the_area_between_lines_and_the_map_stays(studio: Studio) -> None:
    page = studio.page
    page.keyboard.press("b")
    with studio.saying("open to the paper's edge"):
        page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
    page.keyboard.press("p")
    with studio.repainting():
        studio.circle()
    with studio.repainting():
        studio.circle(MIDDLE - 30, MIDDLE, 20)
    maps = studio.predicted()
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#ff8800")
    page.mouse.click(*studio.on_board(MIDDLE + 40, MIDDLE))

    def colour(x: float, y: float) -> list[int]:
        column, row = studio.on_board(x, y)
        page.mouse.move(2, 2)
        return [int(each) for each in studio.screen()[round(row), round(column)]]

    assert colour(MIDDLE + 40, MIDDLE) == [255, 136, 0]
    assert colour(MIDDLE - 30, MIDDLE) == [255, 255, 255]  # another area
    assert studio.inked(MIDDLE, MIDDLE - 80)  # the line lies above
    page.locator("#view-lit").click()
    page.locator("#material-colours").click()
    page.locator("#fill-colour").fill("#0044ff")
    page.mouse.click(*studio.on_board(MIDDLE + 40, MIDDLE))
    column, row = studio.on_result(MIDDLE + 40, MIDDLE)
    studio.until(
        lambda: studio.screen()[round(row), round(column)].astype(int), lambda lit: lit[2] > lit[0] + 60
    )
    assert studio.predicted() == maps
    page.locator("#history summary").click()
    page.locator("#history-list li").first.wait_for()
    assert page.locator("#history-list li").all_inner_texts()[-2:] == ["Area filled", "Area filled"]
    page.locator("#history summary").click()
    page.keyboard.press("s")
    studio.line((MIDDLE + 80, MIDDLE), (MIDDLE + 90, MIDDLE + 10), (MIDDLE + 100, MIDDLE))  # its line
    page.keyboard.press("Escape")
    assert colour(MIDDLE + 92, MIDDLE) == [0, 68, 255]  # moves with it
    page.keyboard.press("Control+z")
    page.keyboard.press("b")
    page.mouse.click(*studio.on_board(MIDDLE + 40, MIDDLE))
    assert colour(MIDDLE + 40, MIDDLE) == [255, 255, 255]  # the same colour again takes it away
    page.locator("#history summary").click()
    page.locator("#history-list").get_by_text("Fill deleted").wait_for()
    page.locator("#history summary").click()
    page.keyboard.press("Control+z")
    page.keyboard.press("e")
    with studio.repainting():
        studio.line((MIDDLE + 40, MIDDLE - 30), (MIDDLE + 40, MIDDLE + 30))
    assert colour(MIDDLE + 40, MIDDLE) == [255, 255, 255]
    assert colour(MIDDLE + 65, MIDDLE) == [0, 68, 255]


def test_a_fill_is_selected_by_a_click_and_moved_without_its_lines(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle()
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#ff8800")
    page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
    maps = studio.predicted()

    def colour(x: float, y: float) -> list[int]:
        column, row = studio.on_board(x, y)
        page.mouse.move(2, 2)
        return [int(each) for each in studio.screen()[round(row), round(column)]]

    page.keyboard.press("s")
    studio.line((MIDDLE, MIDDLE), (MIDDLE + 20, MIDDLE), (MIDDLE + 30, MIDDLE))
    assert page.locator("#select-remove").is_disabled()  # a drag that starts on it draws a marquee
    page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
    assert page.locator("#select-remove").is_enabled()
    studio.line((MIDDLE, MIDDLE), (MIDDLE + 15, MIDDLE), (MIDDLE + 30, MIDDLE))
    page.keyboard.press("Escape")
    assert colour(MIDDLE + 98, MIDDLE) == [255, 136, 0]
    assert colour(MIDDLE - 65, MIDDLE) == [255, 255, 255]
    assert studio.inked(MIDDLE - 80, MIDDLE)  # the line stays
    page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))
    page.keyboard.press("Delete")
    assert colour(MIDDLE, MIDDLE) == [255, 255, 255]
    assert studio.inked(MIDDLE - 80, MIDDLE)
    assert studio.predicted() == maps
    page.keyboard.press("Control+z")
    assert colour(MIDDLE, MIDDLE) == [255, 136, 0]


def test_a_copy_moves_with_its_own_points_and_colour_alone(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle(80, 80, 40)
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#ff8800")
    page.mouse.click(*studio.on_board(90, 80))
    page.keyboard.press("h")
    with studio.repainting():
        page.mouse.click(*studio.on_board(80, 80))
    page.locator("#point-done").click()
    page.keyboard.press("s")
    page.keyboard.press("Control+a")
    page.keyboard.press("Control+d")
    page.locator("#history summary").focus()  # nudged wherever the focus is
    with studio.repainting():
        for _ in range(8):
            page.keyboard.press("Shift+ArrowRight")
    page.mouse.move(2, 2)

    def colour(x: float, y: float) -> list[int]:
        column, row = studio.on_board(x, y)
        return [int(each) for each in studio.screen()[round(row), round(column)]]

    assert colour(60, 80) == colour(152, 92) == [255, 136, 0]
    # Line, fill, point, copy, and one step for all nudges.
    assert [hint["x"] for hint in layer_after(studio, 5)["hints"]] == [79.5, 171.5]


def test_the_colour_of_an_area_stays_with_the_lines_that_bound_it(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle()
    with studio.repainting():
        studio.circle(MIDDLE - 30, MIDDLE, 20)
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#ff8800")
    page.mouse.click(*studio.on_board(MIDDLE - 30, MIDDLE))  # an eye
    page.keyboard.press("s")
    page.mouse.click(*studio.on_board(MIDDLE + 80, MIDDLE))
    with studio.repainting():
        studio.line((MIDDLE + 80, MIDDLE), (MIDDLE + 70, MIDDLE + 10), (MIDDLE + 60, MIDDLE + 30))
    page.keyboard.press("Escape")
    page.mouse.move(2, 2)
    column, row = studio.on_board(MIDDLE - 30, MIDDLE - 14)
    assert [int(each) for each in studio.screen()[round(row), round(column)]] == [255, 136, 0]
