"""Makes the documentation's pictures of the studio, with the shipped model.

tools/studio_pictures.py [FOLDER] [DRAWING]: the target folder (docs/pictures), and the open drawing. It needs
Playwright, and Chromium on the PATH or in NORMALGAN_CHROMIUM.
"""

import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).parents[1]
WEBGL = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
PAINTED = """() => document.getElementById("result").ariaBusy === "false"
  && document.getElementById("result").dataset.painted"""
RAISED = "() => document.getElementById('note').textContent === ''"


@contextmanager
def studio(drawing: Path) -> Iterator[str]:
    """Run a studio with an open drawing and a project folder of its own, and yield its address."""
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "normalgan", "studio", str(drawing), "--no-browser"]
        server = subprocess.Popen(
            [*command, "--port", "0", "--projects", folder], stdout=subprocess.PIPE, text=True
        )
        try:
            assert server.stdout is not None
            address = re.search(r"http://\S+/", server.stdout.readline())
            assert address
            yield address[0]
        finally:
            server.terminate()
            server.wait()


def drag(page: Page, element: str, by: tuple[float, float]) -> None:
    """Drag from the centre of an element, by shares of its size."""
    box = page.locator(element).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + by[0] * box["width"], y + by[1] * box["height"], steps=4)
    page.mouse.up()


def shoot(page: Page, path: Path) -> None:
    """Write a screenshot of the window once it no longer changes."""
    page.mouse.move(5, 400)
    page.wait_for_function(PAINTED)
    page.wait_for_timeout(1500)
    page.screenshot(path=path)


def film(page: Page, path: Path) -> None:
    """Write one picture of six screenshots, from the first stroke to the export."""
    page.locator("#new").click()
    page.locator("#choose button[value=drop]").click()
    page.locator("#new-dialog button.strong").click()
    page.locator("#view-map").click()
    box = page.locator("#board").bounding_box()
    assert box is not None
    x, y, radius = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 0.3 * box["height"]
    frames = []

    def stroke(*points: tuple[float, float]) -> None:
        page.mouse.move(x + points[0][0] * radius, y + points[0][1] * radius)
        page.mouse.down()
        for right, down in points[1:]:
            page.mouse.move(x + right * radius, y + down * radius, steps=3)
        page.mouse.up()

    def shot(*, predicted: bool = True) -> None:
        if predicted:
            page.wait_for_function(PAINTED)
        page.wait_for_timeout(1000)
        frames.append(Image.open(BytesIO(page.screenshot())).convert("RGB"))

    page.keyboard.press("p")
    page.locator("#symmetry").click()
    stroke((0, -0.9), (0.35, -0.86), (0.72, -0.6), (0.9, -0.1), (0.86, 0.4), (0.6, 0.8), (0, 0.92))
    shot()
    stroke((0.1, -0.1), (0.3, -0.3), (0.55, -0.2), (0.5, 0.02), (0.25, 0.06), (0.1, -0.1))
    stroke((0, 0.45), (0.25, 0.5), (0.45, 0.36))
    shot()
    page.keyboard.press("2")
    page.keyboard.press("h")
    page.mouse.click(x, y + 0.22 * radius)
    drag(page, "#ball", (0, -0.3))
    shot()
    page.keyboard.press("Escape")
    page.keyboard.press("m")
    page.keyboard.press("x")  # the brush
    stroke((0.85, 0), (1.25, -0.3), (1.3, -0.6))
    stroke((-0.85, 0), (-1.25, -0.3), (-1.3, -0.6))
    shot()
    page.keyboard.press("l")
    page.locator("#light-both").check()
    page.locator("#light-2").fill("#ff5030")
    page.keyboard.press("c")
    shot()
    page.keyboard.press("c")
    page.locator("#export").click()
    page.locator("#export-engines input[value=unity]").check()
    shot(predicted=False)
    page.keyboard.press("Escape")
    # Maps have too many colours for a palette, which would show bands.
    tiled(frames).save(path, optimize=True)


def layers(page: Page, path: Path) -> None:
    """Write a screenshot with three filled layers: a head in front of a body in front of an arm."""
    page.locator("#new").click()
    page.locator("#choose button[value=drop]").click()
    page.locator("#new-dialog button.strong").click()
    page.locator("#view-lit").click()
    page.locator("#layers-toggle").click()
    page.keyboard.press("p")
    if page.locator("#symmetry").get_attribute("aria-pressed") == "true":
        page.keyboard.press("y")
    box = page.locator("#board").bounding_box()
    assert box is not None
    x, y, radius = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 0.42 * box["width"]
    parts = (
        ("Arm", "#d9a06b", (0.5, 0.1), 0.32, 0.5),
        ("Body", "#4a7fb5", (0, 0.35), 0.5, 0.85),
        ("Head", "#e8b98a", (-0.12, -0.4), 0.4, 0.95),
    )
    for number, (name, colour, (right, down), wide, tall) in enumerate(parts):
        if number:
            page.locator("#layer-add").click()
        for i in range(61):
            angle = math.tau * i / 60
            across = right + wide * math.cos(angle) * (1 + 0.1 * math.sin(2 * angle))
            page.mouse.move(x + radius * across, y + radius * (down + wide * tall * math.sin(angle)))
            if i == 0:
                page.mouse.down()
        page.mouse.up()
        page.wait_for_function(PAINTED)
        page.locator("#layer-name").click()
        page.keyboard.type(name)
        page.keyboard.press("Enter")
        page.locator("#board").focus()
        page.keyboard.press("b")
        page.locator("#fill-colour").fill(colour)
        page.mouse.click(x + radius * right, y + radius * down)
        page.keyboard.press("p")
    page.locator("#material-colours").click()
    shoot(page, path)
    page.locator("#material-clay").click()
    page.locator("#layers-close").click()


def structures(page: Page, path: Path) -> None:
    """Write a screenshot with an egg that shows each structure as a band."""
    page.locator("#new").click()
    page.locator("#choose button[value=drop]").click()
    page.locator("#new-dialog button.strong").click()
    page.keyboard.press("p")
    box = page.locator("#board").bounding_box()
    assert box is not None
    x, y, radius = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 0.42 * box["width"]

    def stroke(*points: tuple[float, float]) -> None:
        page.mouse.move(x + points[0][0] * radius, y + points[0][1] * radius)
        page.mouse.down()
        for right, down in points[1:]:
            page.mouse.move(x + right * radius, y + down * radius)
        page.mouse.up()
        page.wait_for_function(PAINTED)

    stroke(*((0.85 * math.sin(math.tau * i / 60), math.cos(math.tau * i / 60)) for i in range(61)))
    page.keyboard.press("Shift+W")
    for band in range(5):
        if band:
            page.keyboard.press("Shift+G")
        down = -0.7 + 0.35 * band
        reach = 0.85 * math.sqrt(1 - down * down)
        stroke((-reach, down), (0, down + 0.06), (reach, down))
    page.locator("#structure-choose").click()
    shoot(page, path)
    page.keyboard.press("Escape")
    # Clay has so few colours that a palette shows no bands, and halves the size.
    Image.open(path).convert("RGB").quantize(256).save(path, optimize=True)


def tiled(frames: list[Image.Image]) -> Image.Image:
    """Return the pictures at half size, two in a row."""
    width, height = frames[0].width // 2, frames[0].height // 2
    strip = Image.new("RGB", (2 * width + 8, 3 * height + 16), "white")
    for i, frame in enumerate(frames):
        small = frame.resize((width, height), Image.Resampling.LANCZOS)
        strip.paste(small, ((i % 2) * (width + 8), (i // 2) * (height + 8)))
    return strip


def main(
    folder: Path = ROOT / "docs" / "pictures", drawing: Path = ROOT / "examples/sketches/fox.png"
) -> None:
    """Write the pictures."""
    chromium = shutil.which(os.environ.get("NORMALGAN_CHROMIUM") or "chromium")
    with studio(drawing) as address, sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=chromium, args=WEBGL).new_page(
            viewport={"width": 1280, "height": 760}
        )
        page.set_default_timeout(90_000)
        page.add_init_script("localStorage.setItem('normalgan-first-steps', '4')")
        page.goto(address)
        page.wait_for_selector("html[data-ready]")
        page.wait_for_function(PAINTED)
        page.keyboard.press("h")
        page.locator("#suggest").click()
        page.locator(".offer").first.click()
        drag(page, "#ball", (0.1, -0.2))
        shoot(page, folder / "studio_light.png")
        page.keyboard.press("Escape")
        page.emulate_media(color_scheme="dark")
        page.keyboard.press("5")
        page.wait_for_function(RAISED)
        drag(page, "#viewer", (0.15, 0.05))
        shoot(page, folder / "studio_dark.png")
        page.emulate_media(color_scheme="light")
        film(page, folder / "studio_film.png")
        layers(page, folder / "studio_layers.png")
        structures(page, folder / "studio_structures.png")
        page.keyboard.press("p")
        page.set_viewport_size({"width": 420, "height": 860})
        page.keyboard.press("2")
        shoot(page, folder / "studio_narrow.png")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]))
