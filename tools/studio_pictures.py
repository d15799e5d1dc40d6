"""Makes the pictures of the studio that the docs show, with the model that comes with the package.

tools/studio_pictures.py [FOLDER] [DRAWING]: where they go (docs/pictures), and what is open in them. Needs
Playwright, and Chromium on the PATH or as NORMALGAN_CHROMIUM.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).parents[1]
WEBGL = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
PAINTED = """() => document.getElementById("result").ariaBusy === "false"
  && document.getElementById("result").dataset.painted"""
RAISED = "() => document.getElementById('note').textContent === ''"


@contextmanager
def studio(drawing: Path) -> Iterator[str]:
    """Run a studio with a drawing open and projects of its own; yield its address."""
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
    """Drag from an element's middle, by shares of its size."""
    box = page.locator(element).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + by[0] * box["width"], y + by[1] * box["height"], steps=4)
    page.mouse.up()


def shoot(page: Page, path: Path) -> None:
    """Write the window once it has come to rest."""
    page.mouse.move(5, 400)
    page.wait_for_function(PAINTED)
    page.wait_for_timeout(1500)
    page.screenshot(path=path)


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
        page.set_viewport_size({"width": 420, "height": 860})
        page.keyboard.press("2")
        shoot(page, folder / "studio_narrow.png")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]))
