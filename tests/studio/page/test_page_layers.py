"""The studio's layers: each has its own form and marks; the front one hides the others."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from studio_page import SIDE, Hand, OnlyPage, Point, Server, Studio, open_studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2


@pytest.fixture
def studio(only_page: OnlyPage) -> Iterator[Studio]:
    """An empty drawing, the panel of layers, and how many bytes of which layers were sent to be painted."""
    with only_page.renewed() as page:
        page.page.locator("#layers-toggle").click()
        page.new()
        page.page.evaluate(
            """() => {
              window.sent = [];
              const ask = window.fetch;
              window.fetch = (path, options) => {
                if (path === "/api/predict") {
                  const length = new DataView(options.body.buffer).getUint32(0, true);
                  const text = new TextDecoder().decode(options.body.subarray(4, 4 + length));
                  const { layers } = JSON.parse(text);
                  sent.push(layers.map(({ name, bytes }) => [name, bytes]));
                }
                return ask(path, options);
              };
            }"""
        )
        yield page


def names(studio: Studio) -> list[str]:
    """Return what the layers are called, the front one first."""
    return studio.page.locator("#layer-list .name").all_inner_texts()


def add(studio: Studio) -> None:
    """Add a layer in front."""
    studio.page.locator("#layer-add").click()


def two(studio: Studio) -> None:
    """Draw two circles that overlap, each on a layer: the left one round, the right one in front."""
    with studio.repainting():
        studio.circle(MIDDLE - 40)
    with studio.repainting():
        studio.page.keyboard.press("g")
    studio.page.keyboard.press("p")
    add(studio)
    with studio.repainting():
        studio.circle(MIDDLE + 40)


def test_the_front_layer_hides_the_other(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle(MIDDLE - 40)
    with studio.repainting():
        page.keyboard.press("g")
    page.keyboard.press("p")
    back = studio.shown(MIDDLE, MIDDLE)
    add(studio)
    page.evaluate("() => { sent.length = 0; }")
    with studio.repainting():
        studio.circle(MIDDLE + 40)
    front = studio.shown(MIDDLE, MIDDLE)
    assert np.abs(front - back).max() > 0.1
    for layers in page.evaluate("sent"):
        assert [name for name, _ in layers] == ["Layer 1", "Layer 2"]
        assert layers[0][1] == 0  # of what has not changed no pixel is sent
    assert names(studio) == ["Layer 2", "Layer 1"]
    with studio.repainting():
        page.locator("#layer-back").click()
    np.testing.assert_allclose(studio.shown(MIDDLE, MIDDLE), back, atol=0.01)
    assert names(studio) == ["Layer 1", "Layer 2"]
    with studio.repainting():
        page.keyboard.press("Control+z")
    np.testing.assert_allclose(studio.shown(MIDDLE, MIDDLE), front, atol=0.01)
    with studio.repainting():
        page.locator("#layer-list .eye").first.click()
    np.testing.assert_allclose(studio.shown(MIDDLE, MIDDLE), back, atol=0.01)
    assert not studio.inked(MIDDLE + 40 + 80, MIDDLE)


def test_marks_and_erasing_belong_to_the_layer_that_is_worked_on(studio: Studio) -> None:
    page = studio.page
    two(studio)
    with studio.repainting():
        studio.pin(MIDDLE + 60, MIDDLE)
    assert page.locator("#chips .chip").count() == 1
    page.keyboard.press("Escape")
    page.locator("#layer-list .name", has_text="Layer 1").click()
    assert page.locator("#chips .chip").count() == 0
    page.keyboard.press("PageUp")
    assert page.locator("#chips .chip").count() == 1
    page.keyboard.press("PageDown")
    page.keyboard.press("e")
    # Both lines pass here; only that of the back goes.
    with studio.repainting():
        studio.line((MIDDLE + 40, MIDDLE - 20), (MIDDLE + 40, MIDDLE + 20))
    assert not studio.inked(MIDDLE + 40, MIDDLE)
    page.keyboard.press("PageUp")
    assert studio.inked(MIDDLE - 40, MIDDLE)


def test_a_point_goes_to_the_layer_that_is_seen_under_it(studio: Studio) -> None:
    page = studio.page
    two(studio)
    current = page.locator("#layer-list [aria-current] .name")
    with studio.repainting():
        studio.pin(MIDDLE - 60, MIDDLE)
    assert current.inner_text() == "Layer 1"
    page.keyboard.press("Escape")
    with studio.repainting():
        page.mouse.click(*studio.on_board(MIDDLE, MIDDLE))  # Layer 2 hides Layer 1 here
    assert current.inner_text() == "Layer 2"
    page.keyboard.press("Escape")
    # The other layer's point is chosen, though it is not drawn now.
    page.mouse.click(*studio.on_board(MIDDLE - 60, MIDDLE))
    assert current.inner_text() == "Layer 1"
    assert page.locator("#chips .chip").count() == 1


def test_lines_of_another_layer_are_selected_by_a_click_and_by_the_lasso(studio: Studio) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle(60, 60, 40)
    add(studio)
    with studio.repainting():
        studio.circle(190, 190, 40)
    current = page.locator("#layer-list [aria-current] .name")
    page.keyboard.press("s")
    with studio.saying("Working on “Layer 1”."):
        page.mouse.click(*studio.on_board(20, 60))
    assert current.inner_text() == "Layer 1"
    assert page.locator("#select-remove").is_enabled()
    page.keyboard.press("Escape")
    page.keyboard.press("q")
    with studio.saying("Working on “Layer 2”."):
        studio.circle(190, 190, 55)
    assert current.inner_text() == "Layer 2"
    with studio.repainting():
        page.keyboard.press("Delete")
    assert not studio.inked(150, 190)
    page.keyboard.press("PageDown")
    assert studio.inked(20, 60)


def grip(studio: Studio, name: str) -> Point:
    """Return where a layer is taken to be dragged."""
    box = studio.page.locator("#layer-list li", has_text=name).locator(".grip").bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("way", ["mouse", "touch"])
def test_layers_are_dragged_to_their_place(studio: Studio, way: str) -> None:
    page = studio.page
    two(studio)
    add(studio)
    front = studio.shown(MIDDLE, MIDDLE)
    start, end = grip(studio, "Layer 1"), grip(studio, "Layer 3")
    above = end[0], end[1] - 4
    with studio.repainting():
        if way == "mouse":
            page.mouse.move(*start)
            page.mouse.down()
            page.mouse.move(*above, steps=5)
            assert names(studio) == ["Layer 3", "Layer 2", "Layer 1"]  # not before it is let go
            page.mouse.up()
        else:
            hand = Hand(studio)
            hand.put(start)
            for step in range(1, 6):
                hand.move((start[0], start[1] + (above[1] - start[1]) * step / 5))
            hand.lift()
    assert names(studio) == ["Layer 1", "Layer 3", "Layer 2"]
    assert np.abs(studio.shown(MIDDLE, MIDDLE) - front).max() > 0.1
    with studio.repainting():
        page.keyboard.press("Control+z")
    assert names(studio) == ["Layer 3", "Layer 2", "Layer 1"]
    np.testing.assert_allclose(studio.shown(MIDDLE, MIDDLE), front, atol=0.01)


def test_dragging_that_is_given_up_moves_nothing_and_a_click_chooses(studio: Studio) -> None:
    page = studio.page
    two(studio)
    start, end = grip(studio, "Layer 1"), grip(studio, "Layer 2")
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=5)
    page.keyboard.press("Escape")
    page.mouse.up()
    assert names(studio) == ["Layer 2", "Layer 1"]
    assert page.locator("#layer-list .dragged").count() == 0
    page.locator("#layer-list li", has_text="Layer 1").locator(".small").click()
    assert page.locator("#layer-list [aria-current] .name").inner_text() == "Layer 1"


def test_arrow_keys_move_a_layer_and_keep_it_in_hand(studio: Studio) -> None:
    page = studio.page
    two(studio)
    add(studio)
    page.locator("#layer-list li", has_text="Layer 1").locator(".grip").focus()
    with studio.repainting():
        page.keyboard.press("ArrowUp")
    assert names(studio) == ["Layer 3", "Layer 1", "Layer 2"]
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")  # it is the front one already
    assert names(studio) == ["Layer 1", "Layer 3", "Layer 2"]
    assert studio.status() == "“Layer 1” is layer 1 of 3 from the front."
    page.keyboard.press("ArrowDown")
    assert names(studio) == ["Layer 3", "Layer 1", "Layer 2"]
    # The cursor on the drawing, which has the same keys, stays away.
    assert page.evaluate("document.activeElement.className") == "grip"


# Between these the style sheet changes.
@pytest.mark.parametrize("size", [(1280, 800), (1024, 768), (390, 844), (667, 375), (3840, 2160)])
def test_beside_the_layers_every_control_has_its_room(
    opened: "Browser", server: Server, size: tuple[int, int]
) -> None:
    cramped = """() => {
      const found = [];
      const pen = document.createElement("canvas").getContext("2d");
      const controls = "button, select, summary, input, #layers .name";
      const named = (each) => each.id || each.className;
      for (const each of document.querySelectorAll("header *, main *")) {
        if (!each.matches(controls) || !each.checkVisibility()) continue;
        const box = each.getBoundingClientRect();
        for (let around = each.parentElement; around; around = around.parentElement) {
          if (getComputedStyle(around).position === "fixed") break;
          if (getComputedStyle(around).overflow === "visible") continue;
          const limits = around.getBoundingClientRect();
          const beyond = box.left < limits.left - 1 || box.right > limits.right + 1;
          if (beyond) found.push(`${named(each)} is cut off in ${named(around)}`);
        }
        if (each.matches("select")) {
          pen.font = getComputedStyle(each).font;
          // Beside its words there is the arrow.
          const room = box.width - 24 - pen.measureText(each.selectedOptions[0].text).width;
          if (room < 0) found.push(`${each.id} lacks ${-room} pixels`);
        }
        if (each.matches(".name") && each.scrollWidth > each.clientWidth) found.push(each.textContent);
      }
      return found;
    }"""
    with open_studio(opened, server.url, width=size[0], height=size[1]) as studio:
        page = studio.page
        assert page.evaluate(cramped) == []
        page.locator("#paper summary").click()
        assert page.evaluate(cramped) == [], "the paper's card"
        page.keyboard.press("Escape")
        page.locator("#layout-both").click()
        assert page.evaluate(cramped) == [], "both panes"
        page.locator("#layers-toggle").click()
        add(studio)
        for tool in ("pen", "mask", "hint"):
            page.locator(f"#tool-{tool}").click()
            assert page.evaluate(cramped) == [], tool
        page.locator("#layers-close").click()
        page.keyboard.press("r")
        studio.size = 512, 512
        studio.circle(256, 256, 40)
        page.locator("#form-choose").click()
        page.locator("#form-round").click()
        assert page.locator("#form-soft").is_visible()
        assert page.evaluate(cramped) == [], "a region with a form"
        if size == (1024, 768):  # three sliders in one row
            bars = page.locator(".bar").evaluate_all("(bars) => bars.map((each) => each.offsetHeight)")
            assert bars[0] == bars[1]


def test_layers_are_named_removed_and_undone(studio: Studio) -> None:
    page = studio.page
    two(studio)
    page.locator("#layer-name").click()
    page.keyboard.type("Arm")
    page.keyboard.press("Enter")
    assert names(studio) == ["Arm", "Layer 1"]
    assert studio.status() == ""  # not that a layer of another name was added
    with studio.repainting():
        page.locator("#layer-list .eye").first.click()
    page.keyboard.press("p")
    before = studio.predicted()
    with studio.saying("This layer is hidden"):
        studio.line((20, 20), (60, 20))
    assert studio.predicted() == before
    with studio.repainting():
        page.locator("#layer-list .eye").first.click()
    with studio.repainting():
        page.locator("#layer-remove").click()
    assert names(studio) == ["Layer 1"]
    assert page.locator("#layer-remove").is_disabled()
    page.locator("#history summary").click()
    rows = page.locator("#history-list button")
    rows.first.wait_for()  # the list is filled once it is open
    steps = rows.all_inner_texts()
    assert steps[-6:] == [
        "Layer added",
        "Line",
        "Layer renamed",
        "Layer hidden",
        "Layer shown",
        "Layer deleted",
    ]
    page.locator("#history summary").click()
    with studio.repainting():
        page.keyboard.press("Control+z")
    assert names(studio) == ["Arm", "Layer 1"]


def test_layers_are_saved_and_opened_again_with_which_is_worked_on(studio: Studio) -> None:
    page = studio.page
    two(studio)
    shown = studio.shown(MIDDLE, MIDDLE)
    studio.save_as("fox")
    page.locator("#layer-list .name", has_text="Layer 1").click()
    page.reload()
    page.wait_for_selector("html[data-ready]")
    # Another layer to be worked on is nothing that could be lost.
    assert "fox" not in page.locator("#toast-words").inner_text()
    assert page.locator("#layers").is_visible()
    page.locator("#open").click()
    with studio.repainting():
        page.locator(".project", has_text="fox").click()
    assert names(studio) == ["Layer 2", "Layer 1"]
    assert page.locator("#layer-list [aria-current] .name").inner_text() == "Layer 2"
    np.testing.assert_allclose(studio.shown(MIDDLE, MIDDLE), shown, atol=0.01)


def test_a_saved_project_keeps_its_history(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    two(studio)
    page.keyboard.press("Control+z")  # what was undone is kept too
    studio.save_as("past")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    page.locator("#open").click()
    with studio.repainting():
        page.locator(".project", has_text="past").click()
    assert not studio.inked(MIDDLE + 40 + 80, MIDDLE)
    with studio.repainting():
        page.keyboard.press("Control+Shift+z")
    assert studio.inked(MIDDLE + 40 + 80, MIDDLE)
    page.locator("#history summary").click()
    rows = page.locator("#history-list button")
    rows.first.wait_for()  # the list is filled once it is open
    steps = rows.all_inner_texts()
    assert steps == ["Beginning", "Line", "Form changed", "Layer added", "Line"]
    page.locator("#history summary").click()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert names(studio) == ["Layer 1"]
    assert page.locator("#project-name").inner_text() == "past"  # undone or not, it is that project
    page.locator("#open").click()
    with page.expect_download() as waiting:
        page.locator("#download-project").click()
    waiting.value.save_as(tmp_path / "past.normalgan")
    kept = json.loads((tmp_path / "past.normalgan").read_text(encoding="utf-8"))
    assert len(kept["history"]["steps"]) == 5
    # A damaged history is left out, and the drawing is opened.
    kept["history"]["steps"][1] = {"layers": [7], "pictures": [0], "more": {}}
    (tmp_path / "past.normalgan").write_text(json.dumps(kept), encoding="utf-8")
    page.locator("#open-dialog button[value='']").click()
    with studio.saying("Opened"):
        page.set_input_files("#open-file", files=tmp_path / "past.normalgan")
        page.locator("#choose button[value=drop]").click()
    assert page.locator("#undo").is_disabled()
    assert studio.inked(MIDDLE - 40 + 80, MIDDLE)


def test_unsaved_layers_and_their_history_outlive_a_reload(studio: Studio) -> None:
    page = studio.page
    two(studio)
    page.locator("#layer-back").click()
    studio.wait_for_store(lambda kept: kept["doc"]["layers"][0]["name"] == "Layer 2")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    studio.restored()
    assert names(studio) == ["Layer 1", "Layer 2"]
    page.keyboard.press("Control+z")
    assert names(studio) == ["Layer 2", "Layer 1"]
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert names(studio) == ["Layer 1"]
    assert studio.inked(MIDDLE - 40 + 80, MIDDLE)


def test_a_project_of_an_older_version_is_one_layer(studio: Studio, tmp_path: Path) -> None:
    line = [60, 60, 0.5, 190, 60, 0.5, 190, 190, 0.5, 60, 190, 0.5, 60, 60, 0.5]
    older = {
        "format": "normalgan-studio",
        "version": 3,
        "width": SIDE,
        "height": SIDE,
        "strokes": [{"kind": "pen", "size": 6, "points": line}],
        "hints": [{"x": 100, "y": 100, "normal": [0, 0, 1]}],
        "areas": [],
        "mask": [],
        "layers": [],
        "settings": {"source": "outline", "name": "old"},
    }
    file = tmp_path / "old.normalgan"
    file.write_text(json.dumps(older), encoding="utf-8")
    page = studio.page
    with studio.repainting():
        page.set_input_files("#open-file", files=file)
    assert names(studio) == ["Layer 1"]
    assert page.locator("#chips .chip").count() == 1
    page.keyboard.press("m")
    page.locator("#mask-clear").click()  # back to what is found without being told
    assert page.locator("#mask-clear").is_disabled()
    assert studio.inked(190, 120)
    file.write_text(json.dumps({**older, "version": 6}), encoding="utf-8")
    with studio.saying("newer studio"):
        page.set_input_files("#open-file", files=file)
        page.locator("#choose button[value=drop]").click()
    assert studio.inked(190, 120)
