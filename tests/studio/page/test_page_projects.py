"""The studio's page and what is kept: projects, unsaved work, a server that is killed, files in and out."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from studio_page import AWAY, RADIUS, SIDE, Server, Studio, begun, open_studio, serving

from chromium import storage
from normal_pngs import read_png
from normalgan.normals import flip_green
from onnx_models import write_model

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MIDDLE = SIDE / 2
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120" height="60">'
    '<ellipse cx="60" cy="30" rx="50" ry="22" fill="none" stroke="black" stroke-width="3"/></svg>'
)


PICTURED = """list => {
  const canvas = document.querySelector(`#${list} canvas`);
  if (!canvas) return false;
  const copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const pixels = copy.getImageData(0, 0, canvas.width, canvas.height).data;
  return pixels.some((value, i) => i % 4 === 3 && value > 200 && pixels[i - 1] < 100);
}"""
"""Whether the first tile of a gallery shows ink."""


def open_project(studio: Studio, name: str) -> None:
    studio.size = SIDE, SIDE
    studio.page.locator("#open").click()
    with studio.repainting():
        studio.page.locator(".project", has_text=name).click()


def test_a_saved_project_is_opened_again(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        studio.circle()
        studio.pin(100, 110)
        with studio.repainting():
            studio.turn(0.6, -0.5)
        predicted = studio.shown(100, 110)
        studio.save_as("Füchslein 1")
        assert "Füchslein 1" in studio.page.title()
        studio.page.reload()
        studio.page.wait_for_selector("html[data-ready]")
        studio.page.wait_for_function("() => document.getElementById('result').dataset.painted")
        assert studio.inked(MIDDLE + 80, MIDDLE)  # what the tab showed
        # It is saved: nothing is left to restore.
        assert studio.page.locator("#restore").is_hidden()
        assert studio.page.locator("#toast").is_hidden()
        studio.new()
        open_project(studio, "Füchslein 1")
        assert studio.inked(MIDDLE + 80, MIDDLE)
        np.testing.assert_allclose(studio.shown(100, 110), predicted, atol=0.01)
        assert studio.page.locator("#chips .chip").count() == 1


def test_a_project_is_saved_as_another_one(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        studio.circle()
        studio.save_as("fox")
        page.locator("#open").click()
        page.locator("#save-as").click()
        page.locator("#name-field").fill("vixen")
        with studio.saying("Saved “vixen”."):
            page.keyboard.press("Enter")
        page.locator("#open-dialog").wait_for(state="hidden")  # it would hide what is said
        assert page.locator("#project-name").inner_text() == "vixen"
        page.locator("#open").click()
        page.locator(".project", has_text="vixen").wait_for()
        assert page.locator(".project", has_text="fox").count() == 1


def test_a_project_is_renamed_in_the_gallery_and_by_its_title_and_back(
    opened: "Browser", server: Server
) -> None:
    tolerate = ("status of 412",)
    with open_studio(opened, server.url, tolerate=tolerate) as studio:
        page = studio.page
        for name in ("vixen", "fox"):
            studio.new()
            studio.circle()
            studio.save_as(name)
        studio.line((20, 20), (60, 20))  # not saved
        page.locator("#open").click()
        page.locator(".project", has_text="fox").wait_for()

        def rename(name: str) -> None:
            page.locator("#name-field").fill(name)
            page.keyboard.press("Enter")

        page.get_by_role("button", name="Rename fox").click()
        rename("vixen")
        page.locator("#problem", has_text="already exists").wait_for()  # and both are as they were
        page.get_by_role("button", name="Rename fox").click()
        rename("wolf")
        page.locator(".project", has_text="wolf").wait_for()
        assert page.locator(".project", has_text="fox").count() == 0
        assert page.locator("#project-name").inner_text() == "wolf"
        page.locator("#toast button").click()  # undone, from within the gallery
        page.locator(".project", has_text="fox").wait_for()
        assert page.locator(".project").count() == 2
        studio.dismiss("open")
        page.locator("#project-name").dblclick()
        rename("badger")
        page.locator("#toast", has_text="badger").wait_for()
        with studio.saying("Saved “badger”."):
            page.keyboard.press("Control+s")
        page.keyboard.press("Control+z")  # the name is not a step in history
        assert page.locator("#project-name").inner_text() == "badger"
        page.locator("#open").click()
        page.locator(".project", has_text="badger").wait_for()
        assert sorted(page.locator(".project strong").all_inner_texts()) == ["badger", "vixen"]
        studio.dismiss("open")
        page.keyboard.press("Control+s")


def test_a_drawing_named_on_the_command_line_is_opened_once_in_a_tab(
    opened: "Browser", tmp_path: Path
) -> None:
    (tmp_path / "egg.svg").write_text(SVG)
    model = write_model(tmp_path / "ramp.onnx")
    with (
        serving(model, tmp_path / "projects", str(tmp_path / "egg.svg")) as server,
        open_studio(opened, server.url) as studio,
    ):
        assert "egg" in studio.status()
        studio.page.wait_for_function("() => document.getElementById('result').dataset.painted")
        studio.page.reload()
        studio.page.wait_for_selector("html[data-ready]")
        studio.restored()  # and not imported again
        assert "egg" not in studio.status()


def test_two_tabs_do_not_overwrite_one_another(opened: "Browser", server: Server) -> None:
    tolerate = ("status of 412",)
    with open_studio(opened, server.url) as one, open_studio(opened, server.url, tolerate=tolerate) as two:
        one.new()
        one.circle()
        one.save_as("fox")
        open_project(two, "fox")
        one.line((20, 20), (60, 20))
        with one.saying("Saved"):
            one.page.keyboard.press("Control+s")
        two.line((20, 230), (60, 230))
        two.page.keyboard.press("Control+s")
        choose = two.page.locator("#choose")
        choose.wait_for()
        with two.saying("Saved"):
            choose.locator("button[value=overwrite]").click()
        open_project(one, "fox")
        assert one.inked(40, 230)
        assert not one.inked(40, 20)


def test_unsaved_work_outlives_a_closed_tab_and_a_killed_server(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        with begun(context, server) as studio:
            studio.new()
            with studio.repainting():
                studio.circle()
            server.kill()
            with studio.saying("reach the studio"):
                studio.line((20, 20), (60, 20))  # on with it
            assert studio.inked(40, 20)
            with studio.saying("studio is back"):
                server.start()
            studio.line((20, 40), (60, 40))
            studio.page.close()
        with begun(context, server) as studio:
            studio.restored()
            for x, y in ((MIDDLE + 80, MIDDLE), (40, 20), (40, 40)):
                assert studio.inked(x, y)


def test_the_server_keeps_unsaved_work_for_another_browser(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, tolerate=(AWAY,)) as studio:
        studio.new()
        with studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url):
            studio.circle()
        server.kill()
    server.start()
    with open_studio(opened, server.url) as other:  # with a storage of its own, which is empty
        other.size = SIDE, SIDE
        with other.repainting():
            other.page.locator("#restore-yes").click()
        other.page.locator("#restore").wait_for(state="hidden")  # the board moves up
        assert other.inked(MIDDLE + 80, MIDDLE)


def test_saving_a_project_that_another_tab_deleted_asks_nothing(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, tolerate=("status of 412", "status of 404")) as studio:
        studio.new()
        studio.circle()
        studio.save_as("deleted")
        deleted = studio.page.evaluate(
            """async () => {
              const { src } = document.querySelector("script[type=module]");
              const { projects } = await import(src.replace("main", "server/api"));
              await projects.remove("deleted", (await projects.read("deleted")).etag);
              return projects.list();
            }"""
        )
        assert deleted == []
        studio.line((20, 20), (60, 20))
        with studio.saying("Saved “deleted”."):
            studio.page.keyboard.press("Control+s")


def test_projects_of_a_server_that_is_away_are_not_said_to_be_none(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url, tolerate=(AWAY,)) as studio:
        server.kill()
        studio.page.locator("#open").click()
        studio.page.locator("#open-none", has_text="Can't reach the studio").wait_for()


def test_a_folder_of_drawings_is_a_gallery_to_open_them_from(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    for name in ("2.svg", "10.svg", "notes.txt"):
        (tmp_path / name).write_text(SVG)
    with open_studio(opened, server.url) as studio:
        page = studio.page
        page.locator("#open").click()
        page.set_input_files("#open-folder", tmp_path)
        names = page.locator("#folder-list strong")
        studio.until(names.all_inner_texts, ["2.svg", "10.svg"].__eq__)
        page.wait_for_function(PICTURED, arg="folder-list")
        with studio.saying("Imported “10.svg”"):
            page.locator("#folder-list .project").nth(1).click()
        assert page.locator("#pixels").inner_text() == "1024 × 512"  # as large as the server draws an SVG


def test_of_a_file_in_a_folder_that_cannot_be_read_it_is_said_why(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    (tmp_path / "empty.png").write_bytes(b"")
    (tmp_path / "half.normalgan").write_text('{"format": "normalgan-studio", "stro', encoding="utf-8")
    with open_studio(opened, server.url, tolerate=("status of 400",)) as studio:
        page = studio.page
        page.locator("#open").click()
        page.set_input_files("#open-folder", tmp_path)
        for shown in ("drawings", "maps"):
            page.locator("#folder-shown").select_option(shown)
            for words in ("The picture is not an image", "This file is not a studio project"):
                page.locator("#folder-list span", has_text=words).wait_for()


def test_a_gallery_stays_when_one_of_its_files_cannot_be_opened(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    (tmp_path / "empty.png").write_bytes(b"")
    (tmp_path / "half.normalgan").write_text('{"format": "normalgan-studio", "stro', encoding="utf-8")
    with open_studio(opened, server.url, tolerate=("status of 400",)) as studio:
        page = studio.page
        page.locator("#open").click()
        page.set_input_files("#open-folder", tmp_path)
        for i, words in enumerate(("Couldn't import “empty.png”", "This file is not a studio project")):
            with studio.saying(words):
                page.locator("#folder-list .project").nth(i).click()
            assert page.locator("#open-dialog").is_visible()
            whole = page.evaluate(
                """() => {
                  const { x, y, width, height } = document.getElementById("problem").getBoundingClientRect();
                  return [y + 4, y + height - 4].map((row) =>
                    document.elementFromPoint(x + width / 2, row).closest("#problem") !== null);
                }"""
            )
            assert whole == [True, True]  # the dialog's buttons, which stay at its foot, cover nothing of it


def test_the_maps_of_a_folder_are_seen_side_by_side(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    (tmp_path / "1.svg").write_text(SVG)
    (tmp_path / "2.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg' width='64' height='64'/>")
    with open_studio(opened, server.url) as studio:
        page = studio.page
        page.locator("#open").click()
        page.set_input_files("#open-folder", tmp_path)
        colour = """() => {
          const [first] = document.querySelectorAll("#folder-list canvas");
          return [...first.getContext("2d").getImageData(96, 96, 1, 1).data];
        }"""
        page.wait_for_function(PICTURED, arg="folder-list")
        seen = [page.evaluate(colour)]
        for shown in ("maps", "lit"):
            page.locator("#folder-shown").select_option(shown)
            page.locator("#folder-list span", has_text="No lines found").wait_for()  # of the second
            assert page.locator("#folder-list span").first.inner_text() == ""
            seen.append(page.evaluate(colour))
        drawing, map_, lit = seen
        assert map_[2] > 120 > abs(map_[0] - map_[1])  # a normal, blue
        assert max(lit[:3]) - min(lit[:3]) < 30  # clay
        assert drawing != map_ != lit
        with studio.repainting():
            page.locator("#folder-list .project").first.click()


def test_an_exported_map_is_read_back(opened: "Browser", server: Server, tmp_path: Path) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        with studio.repainting():
            studio.circle()
        shown = studio.shown(MIDDLE + 50, MIDDLE - 20)
        studio.page.locator("#export").click()
        studio.page.locator("#export-name").fill("fox")
        studio.page.locator("#export-y").select_option("down")
        with studio.page.expect_download() as waiting:
            studio.page.locator("#export-dialog button.strong").click()
        assert waiting.value.suggested_filename == "fox_normal.png"
        file = tmp_path / "fox_normal.png"
        waiting.value.save_as(file)
    normals, mask = read_png(file)
    assert mask.shape == (SIDE, SIDE)
    assert mask[SIDE // 2, SIDE // 2] == 1
    assert mask[3, 3] == 0
    there = SIDE // 2 - 20, SIDE // 2 + 50
    np.testing.assert_allclose(flip_green(normals)[there], shown, atol=0.05)


def test_a_picture_is_imported_to_draw_on_or_to_trace(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    file = tmp_path / "egg.svg"
    file.write_text(SVG, encoding="utf-8")
    with open_studio(opened, server.url) as studio:
        with studio.saying("egg.svg"):
            studio.page.set_input_files("#import-file", files=file)
            studio.page.locator("#choose button[value=traced]").click()
        assert studio.page.locator("#pixels").inner_text().count("1024") == 1
        assert studio.predicted() == 0  # what is traced is never painted from
        with studio.repainting():
            studio.page.set_input_files("#import-file", files=file)
            studio.page.locator("#choose button[value=drawing]").click()
        studio.page.keyboard.press("Control+z")
        assert studio.page.locator("#empty-result").is_visible()


def test_two_pictures_that_come_together_are_asked_about_one_after_the_other(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    for name in ("first", "second"):
        (tmp_path / f"{name}.svg").write_text(SVG, encoding="utf-8")
    with open_studio(opened, server.url) as studio:
        page = studio.page
        page.evaluate(
            """() => {
              const [ask, held] = [window.fetch, []];
              window.fetch = async (path, options) => {
                const answer = await ask(path, options);
                if (path === "/api/import") {
                  await new Promise((go) => {
                    if (held.push(go) === 2) for (const each of held) each();
                  });
                }
                return answer;
              };
            }"""
        )
        page.set_input_files("#import-file", files=tmp_path / "first.svg")
        page.set_input_files("#import-file", files=tmp_path / "second.svg")
        with studio.saying("Imported"):
            page.locator("#choose button[value=traced]").click()
        with studio.saying("Imported"), studio.repainting():
            page.locator("#choose button[value=drawing]").click()
        assert page.locator("#picture-list li").count() == 1


def test_what_is_drawn_while_a_project_comes_is_asked_about(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        page = studio.page
        studio.new()
        with studio.repainting():
            studio.circle()
        studio.save_as("fox")
        studio.new()
        page.locator("#open").click()
        page.wait_for_function(PICTURED, arg="project-list")  # what is asked for now is what is opened
        page.evaluate(
            """() => {
              const ask = window.fetch;
              window.fetch = async (path, options) => {
                const answer = await ask(path, options);
                if (path === "/api/projects/fox") await new Promise((go) => { window.go = go; });
                return answer;
              };
            }"""
        )
        page.locator(".project", has_text="fox").click()
        page.wait_for_function("() => window.go")
        studio.line((20, 20), (60, 20))
        page.evaluate("() => { go(); window.go = null; }")
        with studio.answering("choose"):
            page.locator("#choose button[value='']").click()
        assert studio.inked(40, 20)
        assert not studio.inked(MIDDLE + 80, MIDDLE)
        page.locator("#open").click()
        page.locator(".project", has_text="fox").click()
        page.locator("#choose button[value=drop]").click()  # asked before it comes, and not again
        page.wait_for_function("() => window.go")
        with studio.saying("Opened"):
            page.evaluate("() => go()")
        assert not studio.inked(40, 20)
        assert studio.inked(MIDDLE + 80, MIDDLE)


def test_restored_work_is_saved_where_it_was_opened_from(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        with begun(context, server) as studio:
            studio.new()
            with studio.repainting():
                studio.circle()
            studio.save_as("fox")
            with studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url):
                studio.line((20, 20), (60, 20))
        with begun(context, server) as studio:
            studio.restored()
            assert "fox" in studio.page.locator("#toast-words").inner_text()
            with studio.saying("Saved"):  # and not: changed elsewhere in the meantime
                studio.page.keyboard.press("Control+s")


def test_all_unsaved_work_is_listed_at_once(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        for y in (60, 120, 180):
            with begun(context, server) as studio:
                if studio.page.locator("#toast").is_visible():  # the first is restored
                    studio.page.locator("#toast button", has_text="Not now").click()
                    studio.page.locator("#empty-board").wait_for()
                studio.new()
                with studio.page.expect_response(lambda answer: "/api/autosave/" in answer.url):
                    studio.line((20, y), (200, y))
        with begun(context, server) as studio:
            studio.page.locator("#restore-all").click()
            rows = studio.page.locator("#restore-list li")
            rows.nth(2).wait_for()
            assert rows.count() == 3
            drawn = "canvas => new Set(canvas.getContext('2d').getImageData(0, 0, 96, 96).data).size > 1"
            assert all(row.locator("canvas").evaluate(drawn) for row in rows.all())
            for undone in (True, False):  # the newest is dropped, which is asked, and can be undone
                rows.nth(0).locator("button").nth(1).click()
                with studio.answering("choose"):
                    studio.page.locator("#choose button[value=drop]").click()
                studio.page.locator("#toast").wait_for()
                if undone:
                    studio.page.locator("#toast button").click()
                studio.page.locator("#restore-all", has_text="3" if undone else "2").click()
                rows.nth(2 if undone else 1).wait_for()
            assert rows.count() == 2
            with studio.repainting():
                rows.nth(1).locator(".project").click()
            studio.page.locator("#restore").wait_for(state="hidden")  # it is kept; the board moves up
            assert studio.inked(100, 60)  # the oldest


def put_back(studio: Studio) -> None:
    """Have a line that was restored put back for later."""
    studio.restored()
    assert studio.inked(100, 60)
    with studio.saying("find it under Open"):
        studio.page.locator("#toast button", has_text="Not now").click()
    assert studio.page.locator("#empty-board").is_visible()


def test_what_was_restored_is_put_back_for_later_and_comes_again(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        leave_line(context, server)
        with begun(context, server) as studio:
            put_back(studio)
        with begun(context, server) as studio:
            put_back(studio)
            studio.page.locator("#open").click()
            studio.page.locator("#open-unsaved").click()
            with studio.saying("Restored"):
                studio.page.locator("#restore-list .project").click()
            assert studio.inked(100, 60)
            # From now on it is this tab's, and what is given up on leaving can be had back.
            studio.page.locator("#new").click()
            studio.page.locator("#choose button[value=drop]").click()
            with studio.answering("new-dialog"):
                studio.page.locator("#new-dialog button.strong").click()
            assert studio.page.locator("#empty-board").is_visible()
            studio.page.locator("#toast button", has_text="Undo").click()
            studio.page.locator("#empty-board").wait_for(state="hidden")
            assert studio.inked(100, 60)
            wait_for_kept(studio, 1, 1)


def test_restored_work_that_is_drawn_on_is_kept_once(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        leave_line(context, server)
        with begun(context, server) as studio:
            studio.restored()
            studio.line((20, 90), (200, 90))
            studio.page.keyboard.press("Control+z")  # as it was restored, which is in no project
            wait_for_kept(studio, 1, 1)
            studio.wait_for_store(
                lambda kept: kept["history"]["at"] == 1 and len(kept["history"]["steps"]) == 3
            )
        with begun(context, server) as studio:
            studio.restored()
            assert studio.inked(100, 60)


def test_restored_work_is_not_offered_to_a_second_tab(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        leave_line(context, server)
        with begun(context, server) as studio:
            studio.restored()
            with begun(context, server) as second:
                assert second.page.locator("#empty-board").is_visible()
                assert second.page.locator("#restore").is_hidden()
                second.page.locator("#open").click()
                assert second.page.locator("#open-unsaved").is_hidden()
        with begun(context, server) as studio:  # its tab is closed
            put_back(studio)
            with begun(context, server) as second:  # and now it is free
                second.restored()
                studio.page.locator("#open").click()
                studio.page.locator("#open-unsaved").click()
                with studio.saying("Another tab has this work open."):
                    studio.page.locator("#restore-list .project").click()
                assert studio.page.locator("#empty-board").is_visible()


def test_each_stroke_is_written_once(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        studio.page.evaluate(
            """() => {
              window.written = [];
              const put = IDBObjectStore.prototype.put;
              IDBObjectStore.prototype.put = function (value, ...key) {
                written.push(JSON.stringify(value).length);
                return put.call(this, value, ...key);
              };
            }"""
        )
        studio.circle()
        for y in range(20, 120, 10):
            studio.line((20, y), (60, y))
        studio.wait_for_store(lambda kept: len(kept["history"]["steps"]) == 12)
        written = studio.page.evaluate("written")
        circle = max(written)
        assert sum(size == circle for size in written) == 1
        assert sum(written) < 3 * circle + 11 * 1000  # and the steps of the history as numbers


def test_a_large_picture_that_is_made_smaller_is_said_to_be(
    opened: "Browser", server: Server, tmp_path: Path
) -> None:
    Image.new("L", (3000, 2000), 255).save(tmp_path / "large.png")
    with open_studio(opened, server.url) as studio:
        with studio.page.expect_file_chooser() as chooser:
            studio.page.locator("#import").click()
        chooser.value.set_files(tmp_path / "large.png")
        with studio.saying("from 3000 × 2000 to 2048 × 1365 pixels"):
            studio.page.locator("#choose button[value=traced]").click()
        assert studio.page.locator("#pixels").inner_text() == "2048 × 1365"


KEPT = """async () => {
  const there = await fetch("/api/autosave").then((answer) => answer.json());
  const here = await new Promise((resolve) => {
    indexedDB.open("normalgan-studio").onsuccess = ({ target: { result: database } }) => {
      database.transaction("unsaved").objectStore("unsaved").count().onsuccess = ({ target: { result } }) => {
        database.close();
        resolve(result);
      };
    };
  });
  return [here, there.length];
}"""
"""How much unsaved work the browser's own store and the server hold."""


def leave_line(context: "BrowserContext", server: Server) -> None:
    """Draw a line in a tab that is closed once the line is kept as unsaved work."""
    with begun(context, server) as studio:
        studio.new()
        studio.line((20, 60), (200, 60))
        wait_for_kept(studio, 1, 1)


def wait_for_kept(studio: Studio, here: int, there: int) -> None:
    """Wait until so much unsaved work is kept: `wait_for_function` takes a promise for true."""
    studio.until(lambda: studio.page.evaluate(KEPT), [here, there].__eq__)


def test_a_reloaded_page_restores_its_own_work_among_others(opened: "Browser", server: Server) -> None:
    with storage(opened, width=1200, height=700) as context:
        leave_line(context, server)
        with begun(context, server) as studio:
            page = studio.page
            page.locator("#toast button", has_text="Not now").click()
            studio.circle()
            wait_for_kept(studio, 2, 2)
            for _ in range(2):  # also before anything else is drawn
                page.reload()
                page.wait_for_selector("html[data-ready]")
                studio.restored()
                assert studio.inked(SIDE / 2 + RADIUS, SIDE / 2)
                assert page.locator("#restore").is_hidden()
            page.locator("#open").click()
            assert page.locator("#open-unsaved").inner_text() == "Unsaved work (1)"


def test_work_that_was_undone_again_is_not_offered_as_unsaved(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        studio.circle()
        studio.save_as("hen")
        sent = "dispatchEvent(new Event('pagehide'))"  # as it is some seconds later
        studio.line((20, 20), (60, 20))
        studio.page.evaluate(sent)
        wait_for_kept(studio, 1, 1)
        studio.page.keyboard.press("Control+z")
        studio.page.evaluate(sent)
        wait_for_kept(studio, 0, 0)
        studio.page.reload()
        studio.page.wait_for_selector("html[data-ready]")
        assert studio.page.locator("#restore").is_hidden()
        assert studio.page.locator("#toast").is_hidden()


def test_undone_work_that_arrived_unanswered_is_taken_back(opened: "Browser", server: Server) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        studio.circle()
        studio.save_as("owl")
        studio.page.evaluate(
            """() => {
              const ask = window.fetch;
              window.fetch = async (path, options) => {
                const answer = await ask(path, options);
                if (options?.method === "PUT" && path.startsWith("/api/autosave")) throw new TypeError("cut");
                return answer;
              };
            }"""
        )
        studio.line((20, 20), (60, 20))
        studio.page.evaluate("dispatchEvent(new Event('pagehide'))")
        wait_for_kept(studio, 1, 1)
        studio.page.keyboard.press("Control+z")
        studio.page.evaluate("dispatchEvent(new Event('pagehide'))")
        wait_for_kept(studio, 0, 0)


def test_a_stroke_that_goes_on_while_another_drawing_is_opened_is_in_neither(
    opened: "Browser", server: Server
) -> None:
    with open_studio(opened, server.url) as studio:
        studio.new()
        page = studio.page
        page.mouse.move(*studio.on_board(40, 40))
        page.mouse.down()
        page.mouse.move(*studio.on_board(90, 90))
        page.evaluate("document.getElementById('new').click()")
        page.locator("#new-dialog").wait_for()
        with studio.answering("new-dialog"):
            page.evaluate("document.querySelector('#new-dialog button.strong').click()")
        page.mouse.move(*studio.on_board(150, 150))
        page.mouse.up()
        assert page.locator("#undo").is_disabled()
        assert not studio.inked(120, 120)
