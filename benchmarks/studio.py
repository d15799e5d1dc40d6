"""Times `normalgan studio` in Chromium at a person's pace, and prints JSON.

studio.py MODEL [--sides 256 512 1024] [--strokes 20] [--memory 0] [--starts 5] [--threads 0]: MODEL is a
model from `normalgan export`, or the folder of the page without a server, site/draw after `make docs`. It
needs Playwright, and Chromium on the PATH or in NORMALGAN_CHROMIUM.

For each side of the drawing it times three things. Strokes with pauses between them: from the end of a stroke
to its visible map, and to the first map of at least half the size. Scribbling at four strokes a second: the
longest time without a new map. A pin turned by its ball: maps per second. `--strokes 0` skips all of this.

`--threads 2` is for the page without a server. On the second visit its networks use half of the cores as
threads, and are told that there are four cores. Each side then says whether the page was isolated, and how
many threads each network has. `--memory 500` draws 500 strokes, and prints how much the page's memory grew
after the first 20, and how much of that in the first half. `--starts 5` loads the page twice in each of
five new browser contexts, and prints the milliseconds until it can be drawn on, and the number of requests.
"""

import argparse
import itertools
import json
import math
import os
import random
import re
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from machine import describe
from playwright.sync_api import Browser, CDPSession, Page, Response, sync_playwright

WATCH = """(side) => {
  window.events = [];
  let lifted = 0;
  const note = (kind, at) => events.push([kind, at]);
  addEventListener("pointerdown", (event) => note("down", event.timeStamp), true);
  addEventListener("pointerup", (event) => note("up", lifted = event.timeStamp), true);
  const result = document.getElementById("result");
  const ask = window.fetch;
  let half = false; // whether the last map shows all strokes at half the size or more
  window.fetch = async (path, options) => {
    const at = performance.now();
    const answer = await ask(path, options);
    if (path === "/api/predict") half = at >= lifted && 2 * Number(answer.headers.get("X-Width")) >= side;
    return answer;
  };
  // The map is visible one frame after the viewer draws it.
  new MutationObserver(() => {
    // Not busy: the map shows all strokes, at its final resolution.
    const kind = result.ariaBusy === "false" ? "whole" : half ? "half" : "map";
    requestAnimationFrame(() => requestAnimationFrame(() => note(kind, performance.now())));
  }).observe(result, { attributeFilter: ["data-painted"] });
}"""
FRAME = 1 / 60
PAUSES = (0.5, 1.5)
"""Seconds between a person's strokes."""
Point = tuple[float, float]
Event = tuple[str, float]


class Hand:
    """A person's hand on the mouse.

    Args:
        page: the studio, with a new drawing.
    """

    def __init__(self, page: Page) -> None:
        self.page = page
        box = page.locator("#board").bounding_box()
        assert box is not None
        self.middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.reach = 0.33 * min(box["width"], box["height"])
        self.chance = random.Random(1)

    def around(self, angle: float, radius: float) -> Point:
        """Return a point of the screen, on a deformed circle about the middle."""
        wave = 1 + 0.15 * math.sin(3 * angle)
        return self.middle[0] + wave * radius * math.cos(angle), self.middle[1] + radius * math.sin(angle)

    def arc(self, count: int) -> list[Point]:
        """Return points of a stroke inside the outline."""
        start = self.chance.uniform(0, math.tau)
        radius = self.chance.uniform(0.2, 0.8) * self.reach
        return [self.around(start + 0.05 * i, radius) for i in range(count)]

    def outline(self) -> None:
        """Draw the outline of the object, and wait for its map."""
        self.stroke([self.around(math.tau * i / 60, self.reach) for i in range(61)])
        self.rest()

    def stroke(self, points: list[Point]) -> None:
        """Draw through points, one per frame of the screen."""
        self.page.mouse.move(*points[0])
        self.page.mouse.down()
        self.follow(points[1:])
        self.page.mouse.up()

    def follow(self, points: list[Point]) -> None:
        """Move through points, one per frame of the screen."""
        end = time.perf_counter()
        for point in points:
            self.page.mouse.move(*point)
            end += FRAME
            time.sleep(max(0.0, end - time.perf_counter()))

    def rest(self) -> None:
        """Wait until the map of all strokes is visible."""
        self.page.wait_for_function(
            "() => Number(document.getElementById('result').dataset.painted ?? 0) > 0"
            " && document.getElementById('result').ariaBusy === 'false'"
        )
        self.page.wait_for_timeout(300)

    def events(self) -> list[Event]:
        """Return the events since the last call."""
        found: list[Event] = self.page.evaluate("() => events.splice(0)")
        return found


def strokes(hand: Hand, count: int) -> dict[str, Any]:
    """Return the milliseconds from the end of each stroke, with pauses between strokes, to its map.

    A map of half the size may come first; ``first`` counts either.
    """
    hand.events()
    for _ in range(count):
        hand.stroke(hand.arc(24))
        time.sleep(hand.chance.uniform(*PAUSES))
    hand.rest()
    events = hand.events()
    # A stroke begun before the previous map arrived shares its map with the previous stroke.
    return {**waits(events, {"whole"}, count), "first": waits(events, {"half", "whole"}, count)}


def waits(events: Sequence[Event], kinds: set[str], count: int) -> dict[str, Any]:
    """Return the milliseconds from the end of each stroke to the first map of these kinds."""
    times, end = [], None
    for kind, at in events:
        if kind == "up":
            end = at
        elif kind in kinds and end is not None:
            times.append(at - end)
            end = None
    found: dict[str, Any] = {"count": count, "with_a_map_of_their_own": len(times)}
    if len(times) < 2:
        return found
    cuts = statistics.quantiles(times, n=20, method="inclusive")
    return {**found, "p50": round(cuts[9]), "p95": round(cuts[18]), "worst": round(max(times))}


def scribble(hand: Hand, seconds: float) -> dict[str, Any]:
    """Return the number of maps shown while a hand scribbles, and the longest time (ms) without a new one."""
    hand.events()
    end, count = time.perf_counter() + seconds, 0
    while time.perf_counter() < end:
        start = time.perf_counter()
        hand.stroke(hand.arc(9))
        time.sleep(max(0.0, start + 0.25 - time.perf_counter()))
        count += 1
    hand.rest()
    events = hand.events()
    begin = next(at for kind, at in events if kind == "down")
    last = max(at for kind, at in events if kind == "up")
    maps = [at for kind, at in events if kind in {"map", "half", "whole"} and at < last]
    gaps = [after - before for before, after in itertools.pairwise([begin, *maps, last])]
    return {"strokes": count, "maps": len(maps), "longest_gap_ms": round(max(gaps))}


def turn(hand: Hand, seconds: float) -> dict[str, Any]:
    """Return the number of maps per second while a pin is turned."""
    page = hand.page
    page.locator("#tool-hint").click()
    page.mouse.click(*hand.around(1, 0.4 * hand.reach))
    page.wait_for_selector("#point:not([hidden])")
    hand.rest()
    box = page.locator("#ball").bounding_box()
    assert box is not None
    middle, radius = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), 0.3 * box["width"]
    page.mouse.move(middle[0] + radius, middle[1])
    page.mouse.down()
    hand.events()
    count = round(seconds / FRAME)
    start = time.perf_counter()
    hand.follow(
        [(middle[0] + radius * math.cos(i / 20), middle[1] + radius * math.sin(i / 20)) for i in range(count)]
    )
    took = time.perf_counter() - start
    maps = sum(kind in {"map", "half", "whole"} for kind, _ in hand.events())
    page.mouse.up()
    hand.rest()
    page.locator("#point-remove").click()
    page.locator("#tool-pen").click()
    return {"maps_a_second": round(maps / took, 1)}


def memory(
    hand: Hand, session: CDPSession, renderers: list[int], answers: list[int], count: int
) -> dict[str, Any]:
    """Return how much the page's memory (MB) grows between the first twenty strokes and the last.

    The browser keeps the bytes of each answer for its driver, up to a limit of its own. They are part of its
    process's memory, and are also reported separately.
    """

    def measured() -> dict[str, float]:
        session.send("HeapProfiler.collectGarbage")
        usage = session.send("Runtime.getHeapUsage")
        found = {
            "heap": usage["usedSize"] / 2**20,
            "objects_of_the_browser": usage["embedderHeapUsedSize"] / 2**20,
            "buffers": usage["backingStorageSize"] / 2**20,
            "answers_kept_for_the_driver": sum(answers) / 2**20,
        }
        pages = [Path(f"/proc/{pid}/status") for pid in renderers]
        if all(page.is_file() for page in pages):  # other systems than Linux measure the heap instead
            kept = [re.search(r"RssAnon:\s+(\d+) kB", page.read_text()) for page in pages]
            found["process"] = sum(int(each[1]) for each in kept if each) / 1024
        return found

    before: dict[str, float] = {}
    halfway: dict[str, float] = {}
    for number in range(count):
        if number == 20:
            before = measured()
        if number == (count + 20) // 2:
            halfway = measured()
        hand.stroke(hand.arc(6))
        time.sleep(0.05)
    hand.rest()
    after = measured()
    return {
        "strokes": count,
        "at_20_mb": {key: round(value, 1) for key, value in before.items()},
        "growth_mb": {key: round(after[key] - before[key], 1) for key in after},
        "of_which_in_the_first_half_mb": {key: round(halfway[key] - before[key], 1) for key in after},
    }


def starts(browser: Browser, address: str, count: int) -> dict[str, Any]:
    """Return how long (ms) the page takes until it can be drawn on, with an empty and with a full cache."""
    found: dict[str, Any] = {}
    times: dict[str, list[float]] = {"cold": [], "again": []}
    for _ in range(count):
        context = browser.new_context(viewport={"width": 1280, "height": 800})
        page = context.new_page()
        for kind, kept in times.items():
            start = time.perf_counter()
            page.goto(address)
            page.wait_for_selector("html[data-ready]")
            kept.append(1000 * (time.perf_counter() - start))
            # A cached resource has a size, but no transfer size.
            asked = "performance.getEntriesByType('resource').filter((each) => each.transferSize > 0).length"
            found[f"{kind}_requests"] = page.evaluate(asked)
        context.close()
    for kind, kept in times.items():
        found[f"{kind}_ms"] = {"p50": round(statistics.median(kept)), "worst": round(max(kept))}
    return found


def begin(page: Page, address: str, side: int, *, again: bool) -> Hand:
    """Open the page, ``again`` for a second visit, and draw an outline on a new drawing."""
    page.goto(address)
    if again:
        page.evaluate("navigator.serviceWorker.ready.then(() => true)")
        page.reload()
    page.wait_for_selector("html[data-ready]")
    page.locator("#new").click()
    page.locator("#new-width").fill(str(side))
    page.locator("#new-height").fill(str(side))
    page.locator("#new-dialog button.strong").click()
    page.evaluate(WATCH, side)
    hand = Hand(page)
    hand.outline()
    return hand


def with_cores(site: Path, folder: Path, cores: int) -> Path:
    """Copy the page without a server into a folder, with a fixed number of cores for its networks."""
    copy = shutil.copytree(site, folder / "draw")
    networks = copy / "page" / "networks.js"
    told = f'Object.defineProperty(navigator, "hardwareConcurrency", {{ value: {cores} }});\n'
    networks.write_text(told + networks.read_text(encoding="utf-8"), encoding="utf-8")
    return copy


@contextmanager
def serving(model: Path, threads: int) -> Iterator[str]:
    """Run the studio, or serve the files of the page without a server, and yield the address."""
    with TemporaryDirectory() as folder:
        studio = ["normalgan", "studio", "--no-browser", "--port", "0", "--model", str(model)]
        site = with_cores(model, Path(folder), 2 * threads) if threads else model
        files = ["http.server", "0", "--bind", "127.0.0.1", "--directory", str(site)]
        command = files if model.is_dir() else [*studio, "--projects", folder]
        server = subprocess.Popen(
            [sys.executable, "-u", "-m", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL if model.is_dir() else None,
            text=True,
        )
        try:
            assert server.stdout is not None
            address = re.search(r"http://\S+/", server.stdout.readline())
            assert address
            yield address[0]
        finally:
            server.terminate()
            server.wait()


def keep(answers: list[int], inside: list[float], response: Response) -> None:
    """Record the bytes of an answer, and the server's milliseconds if it reports them."""
    answers.append(int(response.headers.get("content-length", 0)))
    if "x-seconds" in response.headers:
        inside.append(1000 * float(response.headers["x-seconds"]))


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=Path)
    parser.add_argument("--sides", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--strokes", type=int, default=20)
    parser.add_argument("--memory", type=int, default=0)
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--threads", type=int, default=0)
    given = parser.parse_args()
    if given.threads and not given.model.is_dir():
        parser.error(f"--threads is for the page without a server, but {given.model} is not its folder")
    chromium = shutil.which(os.environ.get("NORMALGAN_CHROMIUM") or "chromium")
    figures: dict[str, Any] = {}
    with serving(given.model, given.threads) as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        if given.starts:
            figures["start"] = starts(browser, address, given.starts)
            print("start", figures["start"], file=sys.stderr, flush=True)
        for side in given.sides:
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            inside: list[float] = []
            answers: list[int] = []
            page.on("response", partial(keep, answers, inside))
            hand = begin(page, address, side, again=given.threads > 0)
            inside.clear()
            found: dict[str, Any] = {}
            if given.threads:
                found["isolated"] = page.evaluate("crossOriginIsolated")
                # Each of the two workers of networks is a thread; the runtime starts the others of both.
                found["threads"] = 1 + sum("ort-wasm" in worker.url for worker in page.workers) // 2
            if given.strokes:
                found["stroke_to_map_ms"] = strokes(hand, given.strokes)
                if inside:
                    found["server_ms"] = {
                        "p50": round(statistics.median(inside)),
                        "worst": round(max(inside)),
                    }
                found |= {"scribble": scribble(hand, 10), "turn": turn(hand, 5)}
            if given.memory:
                processes = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
                renderers = [int(each["id"]) for each in processes if each["type"] == "renderer"]
                session = page.context.new_cdp_session(page)
                found["memory"] = memory(hand, session, renderers, answers, given.memory)
            figures[str(side)] = found
            print(side, found, file=sys.stderr, flush=True)
            page.close()
        browser.close()
    print(json.dumps({**figures, "machine": describe("onnxruntime", "starlette", "playwright")}, indent=1))


if __name__ == "__main__":
    main()
