"""What the studio's page does at its limits: it says so, and nothing that was drawn is lost."""

import json
import math
from pathlib import Path

import pytest
from studio_page import SIDE, Studio

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
MOST_STROKES = 20_000


def test_a_layer_that_is_full_says_so_when_the_pen_comes_down(studio: Studio, tmp_path: Path) -> None:
    page = studio.page
    dot = {"kind": "pen", "size": 3, "points": [20, 20, 0.5]}
    ring = [
        value
        for k in range(61)
        for value in (128 + 60 * math.cos(k / 9.5), 128 + 60 * math.sin(k / 9.5), 0.5)
    ]
    layer = {
        "id": 1, "name": "full", "visible": True, "source": None, "form": None, "hints": [],
        "areas": [], "mask": [],
        "strokes": [{"kind": "pen", "size": 4, "points": ring, "mirror": 140}, *[dot] * (MOST_STROKES - 1)],
    }  # fmt: skip
    whole = {"format": "normalgan-studio", "version": 5, "width": SIDE, "height": SIDE, "layers": [layer]}
    whole |= {"active": 1, "pictures": [], "settings": {"name": "", "file": ""}}
    file = tmp_path / "full.normalgan"
    file.write_text(json.dumps(whole), encoding="utf-8")
    page.keyboard.press("Control+o")
    with studio.repainting():
        page.set_input_files("#open-file", files=file)
    with studio.saying("This layer has the maximum number of lines. Draw on a new layer."):
        studio.line((100, 128), (150, 128))
    assert not studio.inked(125, 128)
    # A mirrored line that is turned would be two.
    page.keyboard.press("Control+a")
    with studio.saying("This layer can't hold that much."):
        page.locator("#select-turn").click()
    assert page.locator("#undo").is_disabled()


def test_a_way_of_many_points_is_thinned_and_goes_as_it_did(studio: Studio) -> None:
    count, off = studio.page.evaluate(
        """async () => {
          const [{ src }] = document.querySelectorAll("script[type=module][src]");
          const { MOST_POINTS, makeRoom } = await import(new URL("drawing/simplify.js", src));
          const points = [], all = [];
          for (let k = 0; k < 3 * MOST_POINTS; k++) {
            const at = [300 + 0.02 * k * Math.cos(k / 90), 300 + 0.02 * k * Math.sin(k / 90)];
            makeRoom(points);
            points.push(...at);
            all.push(at);
          }
          const off = all.map(([x, y]) => {
            let nearest = Infinity;
            for (let i = 0; i + 3 < points.length; i += 2) {
              const [a, b] = [points[i + 2] - points[i], points[i + 3] - points[i + 1]];
              const along = ((x - points[i]) * a + (y - points[i + 1]) * b) / (a * a + b * b);
              const t = Math.max(0, Math.min(1, along));
              nearest = Math.min(nearest, Math.hypot(x - points[i] - t * a, y - points[i + 1] - t * b));
            }
            return nearest;
          });
          return [points.length / 2 / MOST_POINTS, Math.max(...off)];
        }"""
    )
    assert count <= 1
    assert off < 1
