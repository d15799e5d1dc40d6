"""The studio's page under bad input and bad luck: each is said in the page, and nothing drawn is lost."""

import json
import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from studio_page import AWAY, SIDE, Server, Studio, open_studio

from chromium import browser

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2
OFFLINE = "Can't reach the studio. Keep drawing"


def still_there(studio: Studio) -> bool:
    """Return whether the line is there, and goes on to be drawn on."""
    studio.page.keyboard.press("p")
    studio.line((20, 40), (60, 40))
    return studio.inked(MIDDLE, 20) and studio.inked(40, 40)


def test_files_that_are_no_pictures_and_no_projects_are_told(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    (tmp_path / "notes.txt").write_text("milk, bread", encoding="utf-8")
    newer = {"format": "normalgan-studio", "version": 99, "width": 64, "height": 64}
    (tmp_path / "newer.normalgan").write_text(json.dumps(newer), encoding="utf-8")
    pins = [{"x": 9, "y": 9, "normal": normal} for normal in ([0, 0, 1], [0, 0.6, -0.8])]
    layer = {"id": 1, "name": "Legs", "visible": True, "strokes": [], "hints": pins}
    layer |= {"areas": [], "mask": [], "source": None}
    away = {**newer, "version": 5, "layers": [layer], "active": 1, "pictures": []}
    (tmp_path / "away.normalgan").write_text(json.dumps(away), encoding="utf-8")
    (tmp_path / "half.normalgan").write_text('{"format": "normalgan-studio", "stro', encoding="utf-8")
    with open_studio(opened, server.url, tolerate=("status of 400",)) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.line((MIDDLE - 60, 20), (MIDDLE + 60, 20))
        with studio.saying("Couldn't import “notes.txt”: "):
            page.set_input_files("#import-file", files=tmp_path / "notes.txt")
        assert "PNG" in studio.status()  # what would be right
        for file, words in (
            ("newer", "made by a newer studio"),
            ("half", "not a studio project"),
            ("away", "Point 2 of layer “Legs” has the direction [0,0.6,-0.8], which"),
        ):
            page.locator("#open").click()
            with page.expect_file_chooser() as chooser:
                page.locator("#open-file-button").click()
            with studio.saying(words):
                chooser.value.set_files(tmp_path / f"{file}.normalgan")
                page.locator("#choose button[value=drop]").click()
        assert still_there(studio)


def test_texts_of_a_stranger_are_never_markup(opened: "Browser", server: Server, tmp_path: Path) -> None:
    markup = '<img src=x onerror="window.ran=1">'
    layer = {"id": 1, "name": markup, "visible": True, "strokes": [], "hints": []}
    layer |= {"areas": [], "mask": [], "source": None}
    project = {"format": "normalgan-studio", "version": 5, "width": 64, "height": 64, "layers": [layer]}
    project |= {"active": 1, "pictures": [], "settings": {"name": markup, "source": markup}}
    content = json.dumps(project).encode()
    # In the folder it can have any name, if somebody has put it there.
    (tmp_path / f"{markup}.normalgan").write_bytes(content)
    (server._projects / f"{markup}.normalgan").write_bytes(content)
    with open_studio(opened, server.url, tolerate=("status of 400",)) as studio:
        page = studio.page
        studio.new()
        with studio.saying(f"Couldn't import “{markup}.txt”: "):
            page.set_input_files(
                "#import-file", files={"name": f"{markup}.txt", "mimeType": "text/plain", "buffer": b"milk"}
            )
        page.set_input_files("#open-file", files=tmp_path / f"{markup}.normalgan")
        page.wait_for_function(
            "(words) => document.documentElement.outerHTML.includes('img src')", arg=markup
        )
        page.locator("#open").click()
        page.locator("#open-none").wait_for()  # the server lists no project whose name is not valid
        assert page.locator('img[src="x"]').count() == 0
        assert page.evaluate("window.ran") is None


def test_a_full_storage_is_told_and_the_project_can_be_downloaded(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        page.evaluate(
            """() => {
              const full = () => { throw new DOMException("no room", "QuotaExceededError"); };
              IDBObjectStore.prototype.put = full;
              Storage.prototype.setItem = full;
            }"""
        )
        with studio.saying("storage is full"), studio.repainting():
            studio.line((MIDDLE - 60, 20), (MIDDLE + 60, 20))
        page.locator("#view-lit").click()  # which would be remembered
        page.keyboard.press("]")
        assert still_there(studio)
        page.locator("#open").click()
        with page.expect_download() as waiting:
            page.locator("#download-project").click()
        waiting.value.save_as(tmp_path / "kept.normalgan")
        assert (
            len(json.loads((tmp_path / "kept.normalgan").read_text(encoding="utf-8"))["layers"][0]["strokes"])
            == 2
        )


def test_a_server_that_goes_away_in_the_middle_of_anything_is_told(server: Server, tmp_path: Path) -> None:
    (tmp_path / "egg.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>", encoding="utf-8")
    # A relief needs WebGL.
    with browser() as chromium, open_studio(chromium, server.url, tolerate=(AWAY,)) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        studio.line((MIDDLE - 60, 20), (MIDDLE + 60, 20))

        def export() -> None:
            page.locator("#export").click()
            page.locator("#export-dialog button.strong").click()

        def save() -> None:
            page.keyboard.press("Control+s")
            page.locator("#name-field").fill("fox")
            page.keyboard.press("Enter")

        def look() -> None:
            page.locator("#open").click()
            page.locator("#open-dialog button[value='']").click()

        def suggest() -> None:
            page.keyboard.press("h")
            page.locator("#suggest").click()

        def draw() -> None:
            page.keyboard.press("p")
            studio.line((30, 200), (60, 200))

        actions: list[Callable[[], None]] = [
            export,
            save,
            look,
            lambda: page.set_input_files("#import-file", files=tmp_path / "egg.svg"),
            suggest,
            lambda: page.locator("#doubt").click(),
            lambda: page.locator("#view-relief").click(),
            draw,
        ]
        server.kill()
        for action in actions:
            with studio.saying(OFFLINE):
                action()
            # Autosave may have told it first: then what was done here says for a moment that it goes on.
            page.wait_for_function(
                "words => (({ textContent: said }) => !said || said.startsWith(words))"
                "(document.getElementById('status'))",
                arg=OFFLINE,
            )
            assert studio.status().startswith(OFFLINE)
        page.locator("#view-map").click()
        page.locator("#doubt").click()
        assert still_there(studio)
        with studio.repainting():
            with studio.saying("The studio is back"):
                server.start()
            assert re.match("The studio is back", studio.status())
        page.keyboard.press("Control+s")
        assert page.locator("#name-field").input_value() == "fox"  # nobody types it again


def test_a_problem_covers_no_toast_stays_in_the_window_and_goes_with_the_next_act(
    opened: "Browser", server: Server
) -> None:
    with open_studio(opened, server.url, tolerate=(AWAY,)) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        page.keyboard.press("m")
        with studio.saying("This area is open to the paper's edge"):
            page.mouse.click(*studio.on_board(8, 8))
        problem = page.locator("#problem")
        page.set_viewport_size({"width": 700, "height": 500})
        studio.wait_for_frame()
        box = problem.bounding_box()
        assert box is not None
        assert box["x"] + box["width"] <= 700
        assert box["y"] + box["height"] <= 500
        page.set_viewport_size({"width": 1200, "height": 700})
        page.keyboard.press("p")
        assert problem.is_hidden()  # it was said of another tool
        page.locator("#new").click()
        page.locator("#choose button[value=drop]").click()
        page.locator("#new-dialog button.strong").click()
        page.locator("#toast").wait_for()
        server.kill()
        with studio.saying(OFFLINE):
            studio.line((30, 200), (60, 200))
        studio.wait_for_frame()
        shown, toast = problem.bounding_box(), page.locator("#toast").bounding_box()
        assert shown is not None
        assert toast is not None
        assert shown["y"] + shown["height"] < toast["y"]


def test_what_is_drawn_while_the_computer_sleeps_is_predicted_and_saved_on_waking(
    opened: "Browser", server: Server
) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        before = studio.predicted()
        server.signal(signal.SIGSTOP)
        try:
            studio.line((MIDDLE - 60, 20), (MIDDLE + 60, 20))
            studio.page.wait_for_function("() => document.getElementById('result').ariaBusy === 'true'")
            assert studio.predicted() == before
        finally:
            server.signal(signal.SIGCONT)
        studio.page.wait_for_function(
            "before => Number(document.getElementById('result').dataset.painted) > before", arg=before
        )
        studio.save_as("fox")
        assert studio.inked(MIDDLE, 20)


def test_a_focus_ring_is_never_cut_off(opened: "Browser", server: Server) -> None:
    clipped = """() => {
      const found = [];
      for (const each of document.querySelectorAll("button, summary, select, input, [tabindex='0']")) {
        if (!each.checkVisibility()) continue;
        each.focus();
        if (document.activeElement !== each) continue;
        const style = getComputedStyle(each);
        const ring = parseFloat(style.outlineOffset) + parseFloat(style.outlineWidth);
        if (!each.matches(":focus-visible") || style.outlineStyle === "none") continue;
        const box = each.getBoundingClientRect();
        for (let around = each.parentElement; around; around = around.parentElement) {
          if (getComputedStyle(around).overflow === "visible") continue;
          const limits = around.getBoundingClientRect();
          const beyond = box.left - ring < limits.left - 0.5 || box.top - ring < limits.top - 0.5
            || box.right + ring > limits.right + 0.5 || box.bottom + ring > limits.bottom + 0.5;
          if (beyond) found.push(`${each.id || each.outerHTML} in ${around.id || around.className}`);
        }
      }
      return found;
    }"""
    with open_studio(opened, server.url, width=1400, height=800) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        studio.pin(100, 110)
        for tool in ("pen", "hint", "select", "mask", "light"):
            studio.page.locator(f"#tool-{tool}").click()
            studio.page.keyboard.press("Tab")  # a ring is for those who use keys
            assert studio.page.evaluate(clipped) == []
        studio.page.locator("#history summary").click()
        studio.page.keyboard.press("Tab")
        assert studio.page.evaluate(clipped) == []


def test_a_failed_prediction_is_told_until_there_is_a_map(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, tolerate=("status of 500",)) as studio:
        page = studio.page
        studio.new()
        page.clock.install()
        page.route(
            "**/api/predict", lambda route: route.fulfill(status=500, json={"error": "No memory left."})
        )
        with studio.saying("No memory left."):
            studio.line((MIDDLE - 60, 20), (MIDDLE + 60, 20))
        page.clock.run_for(60_000)
        assert page.locator("#problem").is_visible()
        page.unroute("**/api/predict")
        studio.line((20, 40), (60, 40))
        page.locator("#problem").wait_for(state="hidden")
