"""What the studio's page exports: any size from the strokes themselves, all files at once, the clipboard."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from studio_page import RADIUS, SIDE, Studio

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
LOOK = """() => {
  const copy = document.createElement("canvas").getContext("2d");
  copy.drawImage(document.getElementById("export-picture"), 0, 0);
  return [...copy.getImageData(120, 60, 1, 1).data];
}"""
"""The colour of a pixel of the dialog's picture, high up on the ball."""


def export(studio: Studio, path: Path, **fields: str) -> str:
    """Export by the dialog; return what the file is called."""
    page = studio.page
    page.locator("#export").click()
    page.locator(f"#export-engines input[value='{fields.pop('engine', '')}']").check()
    for name, value in fields.items():
        field = page.locator(f"#export-{name}")
        if name in {"what", "format"}:
            field.select_option(value)
        else:
            field.fill(value)
    with page.expect_download() as waiting:
        page.locator("#export-dialog button.strong").click()
    waiting.value.save_as(path)
    return waiting.value.suggested_filename


def test_a_larger_export_has_the_structures_of_the_drawing(ball: Studio, tmp_path: Path) -> None:
    page = ball.page
    page.keyboard.press("Shift+W")
    page.locator("#structure-period").fill("9")  # 384 pixels: the same details at both sizes
    with ball.repainting():
        ball.line((80, 110), (170, 140))
    maps = []
    for size in ("", "512"):
        export(ball, tmp_path / "map.png", name="fox", what="map", format="png8", size=size)
        page.locator("#export-dialog").wait_for(state="hidden")
        maps.append(Image.open(tmp_path / "map.png").convert("RGB"))
    assert [each.size for each in maps] == [(SIDE, SIDE), (2 * SIDE, 2 * SIDE)]
    part = np.s_[100:150, 90:160, :2]
    own, large = (
        np.asarray(each.resize((SIDE, SIDE), Image.Resampling.BOX))[part].astype(int) for each in maps
    )
    assert np.abs(np.diff(own, axis=0)).max() > 20  # scales have edges
    assert np.abs(own - large).mean() < 4
    assert np.corrcoef(np.diff(own, axis=0).ravel(), np.diff(large, axis=0).ravel())[0, 1] > 0.9


def test_the_drawing_is_exported_in_colour(ball: Studio, tmp_path: Path) -> None:
    page = ball.page
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#3070c0")
    page.mouse.click(*ball.on_board(SIDE / 2, SIDE / 2))
    assert export(ball, tmp_path / "colour.png", name="fox", what="colours", size="512") == "fox_colour.png"
    colour = np.asarray(Image.open(tmp_path / "colour.png").convert("RGBA"))
    assert colour.shape == (512, 512, 4)
    assert colour[256, 256].tolist() == [0x30, 0x70, 0xC0, 255]
    assert colour[256, 256 + 2 * RADIUS].tolist() == [0, 0, 0, 255]  # the line lies above
    assert colour[4, 4, 3] == 0


def test_a_larger_export_is_drawn_anew_and_not_enlarged(ball: Studio, tmp_path: Path) -> None:
    assert export(ball, tmp_path / "line.png", name="fox", what="lines", size="1024") == "fox_line.png"
    line = np.asarray(Image.open(tmp_path / "line.png"))[..., 3]
    assert line.shape == (1024, 1024)
    # The edge of an enlarged line is as wide as it was enlarged by; that of a drawn one has two pixels.
    row = line[512].astype(float)
    soft = (row > 8) & (row < 247)
    assert soft.sum() <= 8  # two edges of two sides
    export(ball, tmp_path / "map.png", what="map", format="png8", size="1024")
    alpha = np.asarray(Image.open(tmp_path / "map.png"))[..., 3].astype(float) / 255
    assert alpha.shape == (1024, 1024)
    y, x = np.mgrid[:1024, :1024] + 0.5
    away = np.hypot(x - 512, y - 512)
    rim = away[(alpha > 0.05) & (alpha < 0.95)]
    assert rim.size > 1000
    assert np.ptp(rim) < 8  # no scallops; the hand's circle is one of 40 sides


def test_all_files_come_in_one_zip(ball: Studio, tmp_path: Path) -> None:
    ball.page.keyboard.press("b")
    ball.page.locator("#fill-colour").fill("#3070c0")
    ball.page.mouse.click(*ball.on_board(SIDE / 2, SIDE / 2))
    name = export(ball, tmp_path / "all.zip", name="fox", engine="godot", size="512")
    assert name == "fox_godot.zip"
    with zipfile.ZipFile(tmp_path / "all.zip") as archive:
        assert len(archive.namelist()) == 11  # with what Godot imports the map by
        names = archive.namelist()
        for each in archive.namelist():
            if each.endswith(".png"):
                assert Image.open(io.BytesIO(archive.read(each))).size == (512, 512), each
        preview = Image.open(io.BytesIO(archive.read("fox_preview.png")))
        assert preview.mode == "RGBA"  # the result as it is seen, and not the server's
        colour = Image.open(io.BytesIO(archive.read("fox_colour.png")))
        assert colour.getpixel((256, 256)) == (0x30, 0x70, 0xC0, 255)
    ball.page.locator("#export").click()  # what was chosen is there again
    assert ball.page.locator("#export-engines :checked").input_value() == "godot"
    ball.page.locator("#export-name").fill("fox")
    assert ball.page.locator("#export-files li").all_inner_texts() == names  # it said so before


def test_the_map_is_copied_to_the_clipboard(ball: Studio) -> None:
    page = ball.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.locator("#export").click()
    page.locator("#export-engines input[value='']").check()
    page.locator("#export-what").select_option("map")
    page.locator("#export-size").fill("")  # the last export's is there again
    with ball.saying("Copied"):
        page.locator("#export-copy").click()
    size = page.evaluate(
        """async () => {
          const [item] = await navigator.clipboard.read();
          const bitmap = await createImageBitmap(await item.getType("image/png"));
          return [bitmap.width, bitmap.height];
        }"""
    )
    assert size == [SIDE, SIDE]
    page.locator("#export").click()
    up = page.evaluate(LOOK)
    page.locator("#export-y").select_option("down")
    down = page.evaluate(LOOK)
    assert [down[0], down[1], down[3]] == [up[0], 255 - up[1], up[3]]  # the picture is what will be written
    page.locator("#export-what").select_option("relief")
    assert page.locator("#export-copy").is_disabled()  # a mesh is no picture


def test_the_picture_of_a_relief_is_the_surface_in_the_light(ball: Studio) -> None:
    page = ball.page
    page.locator("#export").click()
    page.locator("#export-engines input[value='']").check()
    seen = {}
    for what in ("map", "lit", "relief"):
        page.locator("#export-what").select_option(what)
        seen[what] = page.evaluate(LOOK)
    assert seen["relief"] == seen["lit"] != seen["map"]


def test_the_dialog_begins_at_the_engine_that_is_chosen(ball: Studio, tmp_path: Path) -> None:
    export(ball, tmp_path / "ball.zip", engine="unity")
    ball.page.locator("#export").click()
    assert ball.page.evaluate("document.activeElement.value") == "unity"
