"""Times `normalgan studio` in Chromium: from a stroke's end to the map on show.

studio.py MODEL [SIDE] [STROKES]: a model by `normalgan export`, the drawing's side in pixels, and how
many strokes are drawn after the outline. Needs Playwright, and Chromium on the PATH or as NORMALGAN_CHROMIUM.
Prints JSON.
"""

import json
import math
import os
import random
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from machine import describe
from playwright.sync_api import Page, sync_playwright

WATCH = """() => {
  window.times = [];
  let end = 0;
  addEventListener("pointerup", (event) => { end = event.timeStamp; }, true);
  // The map is on the screen with the frame after the one in which the viewer draws it.
  new MutationObserver(() => requestAnimationFrame(() => requestAnimationFrame(() => {
    if (end) times.push(performance.now() - end);
    end = 0;
  }))).observe(document.getElementById("result"), { attributeFilter: ["data-painted"] });
}"""


def draw(page: Page, points: list[tuple[float, float]]) -> None:
    """Draw a stroke through points of the screen and wait until its map is on show."""
    count = page.evaluate("times.length")
    page.mouse.move(*points[0])
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*point)
    page.mouse.up()
    page.wait_for_function("count => times.length > count", arg=count)


def measure(page: Page, side: int, strokes: int) -> list[float]:
    """Return the milliseconds of each stroke; the first, which starts everything, is left out."""
    page.locator("#new").click()
    page.locator("#new-width").fill(str(side))
    page.locator("#new-height").fill(str(side))
    page.locator("#new-dialog button.strong").click()
    page.evaluate(WATCH)
    box = page.locator("#board").bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    reach = 0.33 * min(box["width"], box["height"])

    def around(angle: float, radius: float) -> tuple[float, float]:
        wave = 1 + 0.15 * math.sin(3 * angle)
        return middle[0] + wave * radius * math.cos(angle), middle[1] + radius * math.sin(angle)

    draw(page, [around(math.tau * i / 48, reach) for i in range(49)])
    hand = random.Random(1)
    for _ in range(strokes):
        start, radius = hand.uniform(0, math.tau), hand.uniform(0.2, 0.8) * reach
        draw(page, [around(start + 0.1 * i, radius) for i in range(8)])
    times: list[float] = page.evaluate("times")
    return times[1:]


def main(model: Path, side: int = 256, strokes: int = 40) -> None:
    """Print the figures."""
    chromium = shutil.which(os.environ.get("NORMALGAN_CHROMIUM") or "chromium")
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "normalgan", "studio", "--no-browser", "--port", "0"]
        server = subprocess.Popen(
            [*command, "--model", str(model), "--projects", folder], stdout=subprocess.PIPE, text=True
        )
        try:
            assert server.stdout is not None
            address = re.search(r"http://\S+/", server.stdout.readline())
            assert address
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
                )
                page = browser.new_page(viewport={"width": 1280, "height": 800})
                inside: list[float] = []
                page.on(
                    "response",
                    lambda r: (
                        inside.append(1000 * float(r.headers["x-seconds"]))
                        if "x-seconds" in r.headers
                        else None
                    ),
                )
                page.goto(address[0])
                page.wait_for_selector("html[data-ready]")
                times = measure(page, side, strokes)
                browser.close()
        finally:
            server.terminate()
            server.wait()
    cuts = statistics.quantiles(times, n=20)
    figures = {
        "drawing_pixels": side,
        "strokes": len(times),
        "stroke_to_map_ms": {"p50": statistics.median(times), "p95": cuts[18], "worst": max(times)},
        "server_ms": {"p50": statistics.median(inside), "worst": max(inside)},
        "machine": describe("onnxruntime", "starlette", "playwright"),
    }
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:4]))
