"""Unsaved work in a browser that keeps it on the disk: large pictures, full disks, killed browsers."""

import json
import math
import signal
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import pytest
from PIL import Image
from studio_page import SIDE, Server, Studio, begun, sending_nothing_late

from chromium import PATIENCE, profile

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
KB, MB = 2**10, 2**20

CHANGED = """version => new Promise((resolve, reject) => {
  const request = indexedDB.open("normalgan-studio", version);
  request.onupgradeneeded = () => {
    const { result, transaction } = request;
    if (version === 1) result.createObjectStore("unsaved", { keyPath: "tab" });
    else result.createObjectStore("of-a-newer-studio");
  };
  request.onblocked = () => reject(new Error("another page keeps the database"));
  request.onerror = () => reject(request.error);
  request.onsuccess = () => { window.held = request.result; resolve(request.result.version); };
})"""
"""Opens the database as a studio of another version does."""


def write_noise(path: Path, size: int) -> None:
    """Write a square PNG of about so many bytes, at least as large as a drawing; noise cannot be packed."""
    side = max(SIDE, math.ceil(math.sqrt(size / 3)))
    picture = np.full((side, side, 3), 255, np.uint8)
    rows = round(size / 3 / side)
    picture[:rows] = np.random.default_rng(0).integers(0, 256, (rows, side, 3), np.uint8)
    Image.fromarray(picture).save(path)


def trace(studio: Studio, file: Path, said: str = "Imported") -> None:
    """Import a picture to trace, of which the page says this."""
    with studio.saying(said):
        studio.page.set_input_files("#import-file", files=file)
        studio.page.locator("#choose button[value=traced]").click()


@pytest.mark.parametrize("size", [KB, 64 * KB, 8 * MB])
def test_unsaved_work_with_a_picture_is_restored(server: Server, tmp_path: Path, size: int) -> None:
    write_noise(tmp_path / "noise.png", size)
    with profile(tmp_path / "profile") as context:
        with begun(context, server) as studio:
            studio.new()
            trace(studio, tmp_path / "noise.png")
            studio.line((20, 20), (200, 20))
            studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 3)
        server.reset()  # what is restored is the browser's
        with begun(context, server) as studio:  # and in every later tab
            studio.restored()
    with profile(tmp_path / "profile") as context, begun(context, server) as studio:
        studio.restored()
        assert studio.page.locator("#picture-list li").count() == 1
        assert studio.inked(100, 20)
        studio.page.keyboard.press("Control+z")
        assert not studio.inked(100, 20)
        studio.page.keyboard.press("Control+z")
        assert studio.page.locator("#picture-list li").count() == 0


def kill(folder: Path) -> None:
    """End the browser of a profile without a warning."""
    mine = [
        process
        for process in psutil.process_iter(["cmdline"])
        if f"--user-data-dir={folder}" in (process.info["cmdline"] or [])
    ]
    assert mine
    for process in mine:
        with suppress(psutil.NoSuchProcess):
            process.send_signal(signal.SIGKILL)
    psutil.wait_procs(mine, PATIENCE / 1000)
    for left in ("SingletonLock", "SingletonSocket", "SingletonCookie"):
        (folder / left).unlink(missing_ok=True)


def test_unsaved_work_outlives_a_killed_browser(server: Server, tmp_path: Path) -> None:
    folder = tmp_path / "profile"
    write_noise(tmp_path / "noise.png", 2 * MB)
    with suppress(Exception), profile(folder) as context:  # which says that it is gone
        studio = Studio(context.new_page(), server.url)
        studio.new()
        trace(studio, tmp_path / "noise.png")
        studio.line((20, 20), (200, 20))
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 3)
        kill(folder)
    server.reset()
    with profile(folder) as context, begun(context, server) as studio:
        studio.restored()
        assert studio.inked(100, 20)
        assert studio.page.locator("#picture-list li").count() == 1


def test_a_browser_that_is_killed_while_it_writes_keeps_what_was_there_before(
    server: Server, tmp_path: Path
) -> None:
    folder = tmp_path / "profile"
    write_noise(tmp_path / "noise.png", 8 * MB)
    with suppress(Exception), profile(folder) as context:
        studio = Studio(context.new_page(), server.url)
        studio.new()
        studio.line((20, 20), (200, 20))
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 2)
        trace(studio, tmp_path / "noise.png")  # which is said once it is on show
        kill(folder)
    server.reset()
    with profile(folder) as context, begun(context, server) as studio:
        studio.restored()
        assert studio.inked(100, 20)


def test_work_on_a_full_disk_is_not_lost_and_it_is_said(server: Server, tmp_path: Path) -> None:
    write_noise(tmp_path / "noise.png", 2 * MB)
    with profile(tmp_path / "profile") as context:
        with begun(context, server, room=MB) as studio:
            studio.new()
            studio.line((20, 20), (200, 20))
            studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 2)
            trace(studio, tmp_path / "noise.png", "storage is full")
            studio.line((20, 40), (200, 40))  # on with it
            assert studio.inked(100, 40)
            studio.page.locator("#open").click()
            with studio.page.expect_download() as waiting:
                studio.page.locator("#download-project").click()
            waiting.value.save_as(tmp_path / "kept.normalgan")
            assert len(json.loads((tmp_path / "kept.normalgan").read_text())["pictures"]) == 1
        server.reset()
        with begun(
            context, server, room=MB
        ) as studio:  # what was kept before the disk was full is still there
            studio.restored()
            assert studio.inked(100, 20)


def test_where_the_disk_was_full_the_servers_newer_copy_is_restored(server: Server, tmp_path: Path) -> None:
    write_noise(tmp_path / "large.png", 2 * MB)
    with profile(tmp_path / "profile") as context:
        with begun(context, server, room=MB) as studio:
            studio.new()
            studio.line((40, 40), (200, 40))
            studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 2)
            trace(studio, tmp_path / "large.png", "storage is full")
            studio.wait_for_server(lambda doc: len(doc["pictures"]) == 1)
            studio.page.locator("#problem-close").click()
            studio.line((40, 120), (200, 120))
            studio.wait_for_server(lambda doc: len(doc["layers"][0]["strokes"]) == 2)
            assert studio.page.locator("#problem").is_hidden()  # once is enough while the server has it
        with begun(context, server, room=MB) as studio:
            studio.restored()
            assert studio.inked(120, 40)
            assert studio.inked(120, 120)
            assert studio.page.locator("#picture-list li").count() == 1


def test_without_room_for_the_history_the_drawing_is_kept(server: Server, tmp_path: Path) -> None:
    write_noise(tmp_path / "noise.png", 2 * MB)
    with profile(tmp_path / "profile") as context:
        with begun(context, server, room=MB) as studio:
            studio.new()
            trace(studio, tmp_path / "noise.png", "storage is full")
            studio.page.locator("#paper summary").click()
            studio.page.locator("#picture-list button").click()
            studio.page.keyboard.press("Escape")
            studio.line((20, 20), (200, 20))
            studio.line((20, 40), (200, 40))
            studio.wait_for_store(lambda kept: len(kept["doc"]["layers"][0]["strokes"]) == 2)
        server.reset()
        with begun(context, server) as studio:
            studio.restored()
            assert studio.inked(100, 20)


def damage(folder: Path) -> None:
    """Delete the files in which a browser keeps large values."""
    large = [path for path in folder.rglob("*") if ".indexeddb.blob" in str(path) and path.is_file()]
    assert large
    for path in large:
        path.unlink()


def test_what_a_damaged_disk_has_left_is_restored_and_the_rest_is_not_thrown_away(
    server: Server, tmp_path: Path
) -> None:
    folder = tmp_path / "profile"
    write_noise(tmp_path / "noise.png", 2 * MB)
    with profile(folder) as context, begun(context, server) as studio:
        studio.new()
        trace(studio, tmp_path / "noise.png")
        studio.line((20, 20), (200, 20))
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 3)
    damage(folder)
    for _ in range(2):  # it is there again the next time
        server.reset()
        with profile(folder) as context, begun(context, server) as studio:
            with studio.saying("1 lines or pictures couldn't be read"):
                studio.page.locator("#restore-yes").click()
            assert studio.inked(100, 20)
            assert studio.page.locator("#picture-list li").count() == 0
            studio.save_as("fox")


def test_the_servers_copy_is_restored_where_the_browsers_is_damaged(server: Server, tmp_path: Path) -> None:
    folder = tmp_path / "profile"
    write_noise(tmp_path / "noise.png", 2 * MB)
    with profile(folder) as context, begun(context, server) as studio:
        studio.new()
        trace(studio, tmp_path / "noise.png")
        studio.line((20, 20), (200, 20))
        studio.wait_for_server(lambda doc: len(doc["layers"][0]["strokes"]) == 1)
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 3)
    damage(folder)
    with profile(folder) as context, begun(context, server) as studio:
        studio.restored()
        assert studio.inked(100, 20)
        assert studio.page.locator("#picture-list li").count() == 1


def test_a_browser_that_keeps_nothing_starts_and_offers_the_servers_copy(
    server: Server, tmp_path: Path
) -> None:
    with profile(tmp_path / "usual") as context, begun(context, server) as studio:
        studio.new()
        with studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url):
            studio.line((20, 20), (200, 20))
    settings = {"profile": {"default_content_setting_values": {"cookies": 2}}}
    (tmp_path / "strict" / "Default").mkdir(parents=True)
    (tmp_path / "strict" / "Default" / "Preferences").write_text(json.dumps(settings))
    with profile(tmp_path / "strict") as context, begun(context, server) as studio:
        assert "Couldn't look for unsaved work" in studio.status()
        with studio.saying("Restored"):
            studio.page.locator("#restore-yes").click()
        assert studio.inked(100, 20)
        with studio.saying("can't keep"):
            studio.line((20, 40), (200, 40))
        studio.save_as("fox")


def test_a_store_that_never_answers_keeps_no_page_from_starting(server: Server, tmp_path: Path) -> None:
    with profile(tmp_path / "profile") as context:
        with begun(context, server) as studio:
            studio.new()
            with studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url):
                studio.line((20, 20), (200, 20))
        context.add_init_script("IDBFactory.prototype.open = () => ({});")
        page = context.new_page()
        page.clock.install()
        page.goto(server.url)
        page.wait_for_load_state("networkidle")
        with sending_nothing_late(page):
            page.clock.run_for(10_000)
            page.wait_for_selector("html[data-ready]")
            assert "doesn't answer" in page.locator("#problem-words").inner_text()
            assert "Unsaved work" in page.locator("#restore-words").inner_text()


def test_a_newer_studio_may_change_the_store_while_an_older_page_is_open(
    server: Server, tmp_path: Path
) -> None:
    with profile(tmp_path / "profile") as context, begun(context, server) as studio:
        studio.new()
        studio.line((20, 20), (200, 20))
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 2)
        newer = context.new_page()
        newer.goto(f"{server.url}page/icon.svg")
        assert newer.evaluate(CHANGED, 3) == 3
        with (
            studio.saying("A newer studio"),
            studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url),
        ):
            studio.line((20, 40), (200, 40))
        assert studio.inked(100, 40)
        with begun(context, server) as other:  # an older page that starts now
            assert "A newer studio" in other.status()


def test_an_older_studios_store_is_taken_over(server: Server, tmp_path: Path) -> None:
    line = {"kind": "pen", "size": 6, "points": [20, 20, 0.5, 200, 20, 0.5]}
    doc = {
        "format": "normalgan-studio",
        "version": 3,
        "width": SIDE,
        "height": SIDE,
        "strokes": [line],
        "hints": [],
        "layers": [],
    }
    with profile(tmp_path / "profile") as context:
        page = context.new_page()
        page.goto(f"{server.url}page/icon.svg")
        page.evaluate(CHANGED, 1)
        page.evaluate(
            """doc => new Promise((done) => {
              const transaction = held.transaction("unsaved", "readwrite");
              transaction.objectStore("unsaved").put({ tab: "old", changed: new Date().toISOString(), doc });
              transaction.oncomplete = done;
            })""",
            doc,
        )
        with begun(context, server) as studio:  # the older page is still there, and holds on
            assert "older studio" in studio.status()
            page.close()
        with begun(context, server) as studio:
            studio.restored()
            assert studio.inked(100, 20)
