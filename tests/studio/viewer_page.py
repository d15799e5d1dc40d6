"""The studio's viewer alone on a page, driven from Python; colours are read from pictures of the screen."""

import base64
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from chromium import page as open_page
from normalgan.inference.outputs.lighting import CLAY_FILE
from normalgan.studio.page_files import PAGE
from web_folder import serve

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

View = Literal["map", "lit", "matcap", "flat", "relief"]
HTML = """<!doctype html><html lang="en"><meta charset="utf-8"><title>viewer</title>
<link rel="icon" href="data:,">
<style>body { margin: 0; background: rgb(60, 70, 80); color: white }
canvas { display: block; outline: none }</style>
<script type="module">
import { Viewer } from "./result/viewer.js";
const text = { reliefNeedsWebgl: "no relief here", contextLost: "lost", webglFailed: "failed:" };
// A new viewer on a new canvas, and nothing left of the one before.
window.renew = (width, height) => {
  window.viewer?.dispose();
  window.canvas?.remove();
  window.canvas = document.createElement("canvas");
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  document.body.append(canvas);
  window.said = [];
  window.moves = [];
  window.viewer = new Viewer(canvas, {
    onError: (sentence) => said.push(sentence), onMove: (move) => moves.push(move.light), text,
  });
};
window.bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
// Two frames: the drawing is asked for in one and shown by the next.
window.shown = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
// A while after that, which is counted here as the viewer counts how long the light has rested.
window.rested = () => shown().then(() => new Promise((done) => setTimeout(done, 300))).then(shown);
</script>"""


class Viewer:
    """A viewer on a page.

    Args:
        page: the page it is on.
        width: of its canvas in CSS pixels.
        height: of its canvas in CSS pixels.
    """

    def __init__(self, page: "Page", width: int, height: int) -> None:
        self.page, self.width, self.height = page, width, height

    def renew(self) -> None:
        """Begin again with a viewer that knows of nothing."""
        self.page.evaluate("([width, height]) => renew(width, height)", [self.width, self.height])

    def set_map(self, rgba: NDArray[np.uint8]) -> None:
        """Show a map (H, W, 4)."""
        self._send("setMap", "bytes(data)", rgba.tobytes(), rgba.shape)

    def set_height(self, heights: NDArray[np.float32]) -> None:
        """Show heights (H, W) in the relief, NaN off the object."""
        self._send("setHeight", "new Float32Array(bytes(data).buffer)", heights.tobytes(), heights.shape)

    def set_view(self, view: View) -> None:
        """Show another view."""
        self.page.evaluate("view => viewer.setView(view)", view)

    def set_light(self, light: tuple[float, float, float]) -> None:
        """Move the light."""
        self.page.evaluate("light => viewer.setLight(light)", list(light))

    def screen(self) -> NDArray[np.uint8]:
        """Return what the canvas shows, over the page's background: (H, W, 3)."""
        self.page.evaluate("shown()")
        clip = {"x": 0, "y": 0, "width": self.width, "height": self.height}
        picture = self.page.screenshot(clip=clip)  # type: ignore[arg-type]
        return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"))

    def _send(self, method: str, expression: str, content: bytes, shape: tuple[int, ...]) -> None:
        self.page.evaluate(
            f"([data, width, height]) => viewer.{method}({expression}, width, height)",
            [base64.b64encode(content).decode(), shape[1], shape[0]],
        )


@contextmanager
def open_viewer(
    opened: "Browser", width: int = 96, height: int = 96, scale: float = 1, tolerate: tuple[str, ...] = ()
) -> Iterator[Viewer]:
    """Open the viewer at a size in CSS pixels; on leaving, its page must have logged nothing."""

    def answer(route: "Route") -> None:
        route.fulfill(content_type="text/html", body=HTML)

    with serve(PAGE) as address, open_page(opened, scale=scale, tolerate=tolerate) as page:
        page.route("**/viewer_alone.html", answer)
        page.route("**/clay.json", lambda route: route.fulfill(path=CLAY_FILE))
        page.goto(f"{address}/viewer_alone.html")
        page.wait_for_function("window.shown !== undefined")
        viewer = Viewer(page, width, height)
        viewer.renew()
        yield viewer
