"""The page in Firefox: unsaved work with large pictures, a browser that is killed, and the lasso."""

import math
from pathlib import Path

import pytest
from studio_page import SIDE, Server
from test_page_lasso import two_circles
from test_page_storage import KB, MB, write_noise

from firefox import Firefox, firefox

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start

KEPT = """
const database = await new Promise((resolve) => {
  indexedDB.open("normalgan-studio").onsuccess = ({ target }) => resolve(target.result);
});
const all = await new Promise((resolve) => {
  const heads = database.transaction("unsaved").objectStore("unsaved");
  heads.getAll().onsuccess = ({ target }) => resolve(target.result);
});
database.close();
return Math.max(0, ...all.map((each) => each.history.steps.length));
"""


def start(running: Firefox, server: Server) -> None:
    running.go(server.url)
    running.wait_for("document.documentElement.dataset.ready")


def draw(running: Firefox, file: Path) -> None:
    """Import a picture to trace and draw a line; return once the browser has kept both."""
    running.choose_file("#import-file", file)
    running.wait_for("document.querySelector('#choose').open")
    running.click("#choose button[value=traced]")
    running.wait_for("document.querySelector('#status').textContent.startsWith('Imported')")
    x, y, width, height = running.run(
        "const box = document.querySelector('#board').getBoundingClientRect();"
        "return [box.x, box.y, box.width, box.height]"
    )
    running.drag((x + 0.4 * width, y + 0.5 * height), (x + 0.6 * width, y + 0.5 * height))
    running.wait_for(f"await (async () => {{ {KEPT} }})() === 3")


def restored(running: Firefox) -> None:
    running.wait_for("document.querySelector('#toast-words').textContent.startsWith('Restored')")
    assert running.run("return document.querySelectorAll('#picture-list li').length") == 1


@pytest.mark.parametrize("size", [KB, 64 * KB, 8 * MB])
def test_unsaved_work_with_a_picture_is_restored_in_firefox(
    server: Server, tmp_path: Path, size: int
) -> None:
    write_noise(tmp_path / "noise.png", size)
    with firefox(tmp_path / "profile") as running:
        start(running, server)
        draw(running, tmp_path / "noise.png")
        running.go("about:blank")
        server.reset()  # what is restored is the browser's
        start(running, server)
        restored(running)
    server.reset()
    with firefox(tmp_path / "profile") as running:
        start(running, server)
        restored(running)


def test_unsaved_work_outlives_a_killed_firefox(server: Server, tmp_path: Path) -> None:
    write_noise(tmp_path / "noise.png", 2 * MB)
    with firefox(tmp_path / "profile") as running:
        start(running, server)
        draw(running, tmp_path / "noise.png")
        running.kill()
    server.reset()
    with firefox(tmp_path / "profile") as running:
        start(running, server)
        restored(running)


def test_the_lasso_cuts_a_picture_in_firefox_with_the_mouse_and_with_a_finger(
    server: Server, tmp_path: Path
) -> None:
    two_circles().save(tmp_path / "circles.png")
    with firefox(tmp_path / "profile") as running:
        start(running, server)
        running.choose_file("#import-file", tmp_path / "circles.png")
        running.wait_for("document.querySelector('#choose').open")
        running.click("#choose button[value=drawing]")
        running.wait_for("document.querySelector('#result').dataset.painted")
        running.click("#tool-select")
        running.click("#select-lasso")
        x, y, width, height = running.run(
            "const box = document.querySelector('#board').getBoundingClientRect();"
            "return [box.x, box.y, box.width, box.height]"
        )
        margin = min(24, width / 20)
        scale = min(width - 2 * margin, height - 2 * margin) / SIDE
        angles = [2 * math.pi * i / 24 for i in range(25)]
        around = [
            (
                x + width / 2 + scale * (70 - SIDE / 2 + 56 * math.cos(a)),
                y + height / 2 + scale * (56 * math.sin(a)),
            )
            for a in angles
        ]
        for kind in ("mouse", "touch"):
            running.drag(*around, kind=kind)
            running.wait_for("!document.querySelector('#select-split').disabled")
            running.click("#select-split")
            running.wait_for("document.querySelector('#status').textContent === 'Moved to “Layer 2”.'")
            running.click("#undo")
            running.wait_for("document.querySelector('#status').textContent === 'Undone.'")
