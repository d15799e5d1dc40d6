"""The studio without a server paints in Chromium what Python paints, with the network cut off."""

import base64
import io
import itertools
import json
import re
import runpy
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import normalgan
from chromium import browser, storage
from chromium import page as open_page
from needs import NPM
from normalgan.inference.cleaning.reader import read
from normalgan.inference.composites.composition import compose
from normalgan.inference.composites.layer_context import context_of, surest, ways_to_see
from normalgan.inference.inputs import as_hints, as_picture
from normalgan.inference.mask.mask_files import MODEL
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import finish, predict
from normalgan.inference.predictor import Predictor
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture, read_picture
from normalgan.inference.suggestion import suggest, uncertainty
from normalgan.normals import Bits
from normalgan.studio.drawings.drawing_request import DrawingRequest
from normalgan.studio.drawings.limits import TILE_SIDE
from normalgan.studio.drawings.schemas import DrawingFields, parse
from normalgan.studio.predictions.figures import FiguresFinding, several_figures
from normalgan.weights.shipped import SHIPPED
from pens import blob, outline
from web_folder import serve

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.slow  # downloads a package of npm
ROOT = Path(__file__).parents[1]
LARGEST = 40e6
STROKE = {"points": [60, 100, 190, 40], "normal": [0.0, 0.0, 1.0], "size": 90, "soft": 0.2}
SIDE = 512
ASK = """async ([drawing, width, height, channels, more, path = "/api/predict"]) => {
  const pixels = Uint8Array.from(atob(drawing), (letter) => letter.charCodeAt(0));
  const planes = [{ name: "ink", width, height, channels, box: [0, 0, width, height] }];
  const layer = { base: null, bytes: width * height * channels, planes, hints: [], areas: [] };
  const count = pixels.length / (width * height * channels);
  const layers = Array.from({ length: count }, (_, id) => ({ ...layer, id, name: `Layer ${id}` }));
  const drawn = count > 1 ? { layers } : layer;
  const fields = { tab: "test", number: 1, source: null, ...drawn, ...more };
  const json = new TextEncoder().encode(JSON.stringify(fields));
  const body = new Uint8Array(4 + json.length + pixels.length);
  new DataView(body.buffer).setUint32(0, json.length, true);
  body.set(json, 4);
  body.set(pixels, 4 + json.length);
  const answer = await fetch(path, { method: "POST", body });
  let text = "";
  for (const byte of new Uint8Array(await answer.arrayBuffer())) text += String.fromCharCode(byte);
  const said = JSON.parse(decodeURIComponent(answer.headers.get("X-Findings") ?? "[]"));
  return { status: answer.status, findings: said, rgba: btoa(text) };
}"""


@cache
def python() -> Predictor:
    """The model that the page has, in Python."""
    return normalgan.load(SHIPPED)


@cache
def blob_in_python() -> NormalMap:
    """The map of a blob drawn in strokes."""
    return of_strokes(np.rint(255 * (1 - outline(blob()))).astype(np.uint8))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site that holds the studio."""
    hook = runpy.run_path(str(ROOT / "tools" / "site" / "static_studio.py"))
    runtime = hook["fetch_runtime"]()
    if runtime is None:
        pytest.skip(NPM.reason("it is not installed, or fetches nothing"))
    folder: Path = tmp_path_factory.mktemp("site") / hook["FOLDER"]
    folder.mkdir()
    hook["build"](folder, runtime)
    return folder


@pytest.fixture(scope="module")
def studio(built: Path) -> Iterator["Page"]:
    """The page, ready to draw on, with the network cut off."""
    requested: list[str] = []
    with serve(built.parent) as address, browser(webgl=False) as opened, open_page(opened) as page:
        page.on("request", lambda each: requested.append(each.url))
        page.goto(f"{address}/{built.name}/")
        page.wait_for_selector("html[data-ready]", timeout=120_000)
        for module in ("suggest", "prepare"):  # of the worker, which tests call alone
            page.evaluate(f"import('./page/{module}.js')")
        page.context.set_offline(True)
        yield page
    assert [url for url in requested if not url.startswith((address, "data:", "blob:"))] == []


def test_the_build_writes_every_constant_that_the_scripts_take(built: Path) -> None:
    promised = (ROOT / "tools" / "static_studio" / "constants.d.ts").read_text(encoding="utf-8")
    written = (built / "page" / "constants.js").read_text(encoding="utf-8")
    modules = dict(re.findall(r"^export const (\w+) = (.*);$", written, re.M))
    for module, names in re.findall(r"^export const (\w+): (.*?);$", promised, re.M | re.S):
        has = json.loads(modules[module])
        wanted = [quoted or named for quoted, named in re.findall(r'"(\w+)"|readonly (\w+):', names)]
        assert wanted
        assert set(wanted) <= set(has), module


def test_it_is_small_enough_to_be_fetched(built: Path) -> None:
    assert sum(path.stat().st_size for path in built.rglob("*") if path.is_file()) < LARGEST


@pytest.mark.parametrize("name", ["dog", "fawn"])
def test_it_paints_what_python_paints(studio: "Page", name: str) -> None:
    picture = read_picture(ROOT / "examples" / "sketches" / f"{name}.png").resized((SIDE, SIDE))
    grey = np.rint(picture.colour[..., 0] * 255).astype(np.uint8)
    assert_alike(studio, grey, [{"x": 250, "y": 240, "normal": [-0.6, 0.0, 0.8]}])


@pytest.mark.parametrize("width", [1, 2])
def test_lines_of_any_width_and_areas_are_shown_as_python_shows_them(studio: "Page", width: int) -> None:
    ink = cv2.dilate(outline(blob()), np.ones((width, width), np.uint8))
    ink[80:96, 160:176] = 1  # an area, too small to be taken for paint
    assert_alike(studio, np.rint(255 * (1 - ink)).astype(np.uint8), [])


def test_gaps_are_closed_as_python_closes_them(studio: "Page") -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    grey[:, 120:128] = 255
    assert_alike(studio, grey, [])


def mug() -> NDArray[np.uint8]:
    """A mug (H, W) whose handle is a ring, with an eye, which is no hole, on its side."""
    grey = np.full((300, 320), 255, np.uint8)
    cv2.rectangle(grey, (50, 60), (190, 250), (0,), 3)
    for radius in (40, 62):
        cv2.ellipse(grey, (190, 155), (radius, radius), 0, -90, 90, (0,), 3, cv2.LINE_AA)
    cv2.circle(grey, (110, 150), 7, (0,), 2, cv2.LINE_AA)
    return grey


def open_blob(gap: slice = slice(112, 142)) -> NDArray[np.uint8]:
    """A blob (H, W) whose outline has a gap that no thicker line closes."""
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    grey[:, gap] = np.where(np.arange(len(grey))[:, None] > 128, 255, grey[:, gap])
    return grey


@pytest.mark.parametrize("drawn", [mug, open_blob])
def test_the_reader_tells_the_object_as_in_python(studio: "Page", drawn: Any) -> None:
    grey = drawn()
    wanted = python()(grey)
    found = studio.evaluate(ASK, [*encoded(as_rgba(grey)), {}])
    mask = decoded(found, grey.shape)[..., 3] > 127
    assert np.count_nonzero(mask != wanted.mask) < 20
    asked = studio.evaluate(ASK, [*encoded(as_rgba(grey)), {"source": "outline"}])
    lines = decoded(asked, grey.shape)[..., 3] > 127
    assert np.count_nonzero(lines != mask) > 500  # or the lines alone would tell it


def test_an_edge_without_a_line_is_told_as_in_python(studio: "Page") -> None:
    grey = open_blob(slice(80, 180))
    (wanted,) = python()(grey).findings
    (said,) = studio.evaluate(ASK, [*encoded(grey), {}])["findings"]
    assert said["code"] == wanted.code == "edge"
    np.testing.assert_allclose(said["places"], wanted.places, atol=3)


def page_of_three() -> NDArray[np.uint8]:
    """A page (H, W) with two figures above a third."""
    page = np.zeros((420, 560), np.float32)
    for centre, radius in (((150, 130), 70), ((420, 140), 60), ((270, 320), 65)):
        page = np.maximum(page, outline(blob((420, 560), centre, radius)))
    return np.rint(255 * (1 - page)).astype(np.uint8)


def filled(outlines: list[list[float]], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    mask = np.zeros(shape, np.uint8)
    cv2.fillPoly(mask, [np.rint(line).astype(np.int32).reshape(-1, 2) for line in outlines], (1,))
    return mask > 0


@pytest.mark.parametrize("longest", [None, 280])
def test_separate_figures_are_told_with_their_outlines_as_in_python(
    studio: "Page", longest: int | None
) -> None:
    grey = page_of_three()
    picture = Picture((grey[..., None].repeat(3, axis=2) / 255).astype(np.float32), None)
    prepared = prepare(picture, python().size, clean_strokes=True)
    (wanted,) = several_figures(prepared, picture)
    assert isinstance(wanted, FiguresFinding)
    (said,) = studio.evaluate(ASK, [*encoded(grey), {"longest": longest}])["findings"]
    assert said["code"] == "figures"
    assert said["count"] == wanted.count == 3
    np.testing.assert_allclose(said["places"], wanted.places, atol=4)
    for mine, other in zip(said["outlines"], wanted.outlines, strict=True):
        one, two = filled(mine, grey.shape), filled([list(line) for line in other], grey.shape)
        assert np.count_nonzero(one & two) > 0.95 * np.count_nonzero(one | two)


@pytest.mark.parametrize("side", [96, 512])
def test_figures_of_a_transparent_sheet_are_told_as_in_python(studio: "Page", side: int) -> None:
    sheet = np.zeros((side, side, 4), np.uint8)
    sheet[..., :3] = 255
    for x, y, radius in ((0.25, 0.25, 0.18), (0.72, 0.3, 0.2), (0.5, 0.75, 0.2), (0.8, 0.56, 0.02)):
        middle, wide = (round(side * x), round(side * y)), round(side * radius)
        cv2.circle(sheet, middle, wide, (255, 255, 255, 255), -1)
        cv2.circle(sheet, middle, wide, (0, 0, 0, 255), max(1, side // 100))
    shown = (sheet / 255).astype(np.float32)
    picture = Picture(shown[..., :3], shown[..., 3])
    (wanted,) = several_figures(prepare(picture, python().size), picture)
    assert isinstance(wanted, FiguresFinding)
    pixels = base64.b64encode(sheet.tobytes()).decode()
    found = studio.evaluate(ASK, [pixels, side, side, 4, {}])["findings"]
    (said,) = (each for each in found if each["code"] == "figures")
    assert said["count"] == wanted.count == 3  # the spark belongs to the figure next to it
    np.testing.assert_allclose(said["places"], wanted.places, atol=1)
    for mine, other in zip(said["outlines"], wanted.outlines, strict=True):
        one, two = filled(mine, (side, side)), filled([list(line) for line in other], (side, side))
        assert np.count_nonzero(one & two) > 0.9 * np.count_nonzero(one | two)  # a pixel wider or narrower


def test_an_open_edge_that_a_layer_in_front_hides_is_not_told(studio: "Page") -> None:
    handle = open_blob(slice(80, 180))
    mug = np.rint(255 * (1 - outline(blob((200, 300), (130, 150), 45)))).astype(np.uint8)
    codes = [
        [each["code"] for each in studio.evaluate(ASK, [*encoded(*layers), {}])["findings"]]
        for layers in ((handle, mug), (mug, handle))
    ]
    assert ["edge" in each for each in codes] == [False, True]


def test_places_on_an_icon_are_in_its_own_pixels(studio: "Page") -> None:
    drawn = cv2.resize(open_blob(slice(80, 180)), (100, 67), interpolation=cv2.INTER_AREA)
    small = np.asarray(drawn, np.uint8)
    (wanted,) = (each for each in python()(small).findings if each.code == "edge")
    (said,) = (
        each for each in studio.evaluate(ASK, [*encoded(small), {}])["findings"] if each["code"] == "edge"
    )
    np.testing.assert_allclose(said["places"], wanted.places, atol=3)


def test_a_lone_small_circle_is_the_object_as_in_python(studio: "Page") -> None:
    grey = np.full((512, 512), 255, np.uint8)
    cv2.circle(grey, (350, 330), 40, (0,), 6, cv2.LINE_AA)
    wanted = python()(grey)
    found = studio.evaluate(ASK, [*encoded(grey), {}])
    codes = [each.code for each in wanted.findings]
    assert [each["code"] for each in found["findings"]] == codes
    assert "regions" not in codes
    assert wanted.mask[330, 350]
    assert decoded(found, grey.shape)[330, 350, 3] == 255


@pytest.mark.parametrize("shape", [(64, 640), (640, 100)])
def test_a_banner_is_the_object_as_in_python(studio: "Page", shape: tuple[int, int]) -> None:
    grey = np.full(shape, 255, np.uint8)
    cv2.rectangle(grey, (8, 8), (shape[1] - 9, shape[0] - 9), (0,), 3)
    wanted = python()(grey).mask
    assert wanted[shape[0] // 2, shape[1] // 2]
    found = decoded(studio.evaluate(ASK, [*encoded(as_rgba(grey)), {}]), grey.shape)[..., 3] > 127
    assert np.count_nonzero(found != wanted) < 20


@pytest.mark.parametrize("drawn", [True, False])
def test_an_opaque_rectangle_is_a_card_or_the_object_as_in_python(studio: "Page", drawn: bool) -> None:
    rgba = np.full((200, 300, 4), (255, 255, 255, 255) if drawn else (120, 120, 120, 255), np.uint8)
    if drawn:
        rgba[..., :3] = np.rint(255 * (1 - outline(blob())))[..., None]
    rgba = np.pad(rgba, ((20, 20), (20, 20), (0, 0)))
    wanted = python()(rgba).mask
    assert wanted[120, 170]
    assert bool(wanted[30, 30]) is not drawn
    found = decoded(studio.evaluate(ASK, [*encoded(rgba), {}]), (240, 340))[..., 3] > 127
    assert np.count_nonzero(found != wanted) < 20


def test_glass_in_an_opaque_outline_belongs_to_the_object_as_in_python(studio: "Page") -> None:
    rgba = np.full((*blob().shape, 4), (120, 180, 220, 0), np.uint8)
    rgba[..., 3] = np.rint(255 * np.maximum(0.4 * blob(), outline(blob())))
    rgba[outline(blob()) > 0.5, :3] = 0
    wanted = python()(rgba)
    assert wanted.mask[100, 150]
    found = decoded(studio.evaluate(ASK, [*encoded(rgba), {}]), wanted.mask.shape)
    assert_near(found, wanted, share=0.98, degrees=2)


def icon(side: int) -> NDArray[np.uint8]:
    """A red disc (side, side, 4) with a dark outline on nothing, drawn large and reduced."""
    big = np.zeros((8 * side, 8 * side, 4), np.float32)
    cv2.circle(big, (4 * side, 4 * side), round(3.2 * side), (0.1, 0.1, 0.1, 1), -1)
    cv2.circle(big, (4 * side, 4 * side), round(2.9 * side), (0.8, 0.2, 0.2, 1), -1)
    small = big.reshape(side, 8, side, 8, 4).mean((1, 3))
    small[..., :3] /= np.maximum(small[..., 3:], 1e-4)
    pixels: NDArray[np.uint8] = np.rint(255 * small).astype(np.uint8)
    return pixels


@pytest.mark.parametrize("side", [16, 32, 48, 128])
def test_an_icon_is_prepared_at_the_size_of_the_model_as_in_python(studio: "Page", side: int) -> None:
    rgba = icon(side)
    wanted = python()(rgba)
    found = decoded(studio.evaluate(ASK, [*encoded(rgba), {}]), (side, side))
    assert_near(found, wanted, share=0.98, degrees=1)
    # Strokes too: a drawing on small paper.
    grey = np.full((side, side), 255, np.uint8)
    cv2.circle(grey, (side // 2, side // 2), side // 3, (0,), 2, cv2.LINE_AA)
    assert_alike(studio, grey, [])
    hints = [{"x": side / 2 + 0.5, "y": side / 2 + 0.5, "normal": [-0.6, 0.0, 0.8]}]
    assert_alike(studio, grey, hints, degrees=2.5)  # the page holds points exactly
    cut = {"points": [side / 2, side / 2], "size": side / 8, "adds": False}
    answer = studio.evaluate(ASK, [*encoded(rgba), {"mask_strokes": [cut]}])
    mask = decoded(answer, grey.shape)[..., 3] > 127
    assert not mask[side // 2, side // 2]
    assert mask[side // 2, side // 2 + side // 5]
    doubt = studio.evaluate(ASK, [*encoded(grey), {}, "/api/uncertainty"])
    assert len(base64.b64decode(doubt["rgba"])) == side * side


def test_a_hole_that_was_filled_meets_the_object_at_its_line(studio: "Page") -> None:
    click = {"points": [206, 155], "size": 1, "adds": True, "fills": True}
    answer = studio.evaluate(ASK, [*encoded(mug()), {"mask_strokes": [click]}])
    handle = cv2.circle(np.zeros_like(mug()), (190, 155), 50, (1,), -1) > 0  # over the hole's rim
    assert (decoded(answer, mug().shape)[handle, 3] == 255).all()


def test_the_reader_runs_once_for_all_sizes_of_a_picture(studio: "Page") -> None:
    networks = {each.evaluate("self.name"): each for each in studio.workers if "networks.js" in each.url}
    assert set(networks) == {"ours refiner", "reader"}  # in two workers, so that they run at once
    counting = "self.runs = 0; addEventListener('message', () => { self.runs += 1; })"
    networks["reader"].evaluate(f"() => {{ {counting} }}")
    for angle, runs in ((30, 1), (40, 2)):
        grey = np.full((SIDE, SIDE), 255, np.uint8)
        cv2.ellipse(grey, (256, 256), (200, 150), angle, 0, 360, (0,), 3, cv2.LINE_AA)
        half, whole = (
            decoded(studio.evaluate(ASK, [*encoded(grey), {"longest": longest}]), (side, side))
            for longest, side in ((SIDE // 2, SIDE // 2), (None, SIDE))
        )
        assert networks["reader"].evaluate("self.runs") == runs
        assert half[SIDE // 4, SIDE // 4, 3] == whole[SIDE // 2, SIDE // 2, 3] == 255


def test_the_mask_brush_cuts_and_adds(studio: "Page") -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    stroke = {"points": [100, 100, 120, 110], "size": 40, "adds": False}
    answer = studio.evaluate(ASK, [*encoded(grey), {"mask_strokes": [stroke]}])
    mask = decoded(answer, grey.shape)[..., 3] > 0
    assert not mask[105, 110]
    whole = studio.evaluate(ASK, [*encoded(grey), {}])
    assert (decoded(whole, grey.shape)[..., 3] > 0)[105, 110]


def test_layers_are_composed_as_python_composes_them(studio: "Page") -> None:
    drawn = [np.full((SIDE, SIDE), 255, np.uint8) for _ in range(2)]
    cv2.ellipse(drawn[0], (230, 280), (165, 90), 0, 0, 360, (0,), 3, cv2.LINE_AA)
    cv2.ellipse(drawn[1], (384, 192), (64, 51), 0, 0, 360, (0,), 3, cv2.LINE_AA)
    model = OnnxBackend(SHIPPED)
    pictures = [Picture(np.dstack([each / np.float32(255)] * 3), None) for each in drawn]
    parts = [prepare(each, model.size, line_widths=model.line_widths) for each in pictures]
    context = context_of(parts)
    chosen = [
        surest(ways_to_see(each, context), lambda way: model.predict(way.model_input, way.hints))
        for each in parts
    ]
    assert [each[0].model_input is context.model_input for each in chosen] == [True, False]
    wanted = compose([finish(*each, model.upsample) for each in chosen])
    found = decoded(studio.evaluate(ASK, encoded(*drawn)), drawn[0].shape)
    assert_near(found, wanted, share=0.98, degrees=1)
    # What has changed can be had first: the other layer is as it was, among the other lines.
    moved = [drawn[0], np.roll(drawn[1], 40, 0)]
    first, then = (
        decoded(studio.evaluate(ASK, [*encoded(*moved), {"changed_only": early}]), found.shape[:2])
        for early in (True, False)
    )
    seen = np.zeros_like(drawn[0], bool)
    seen[240:320, 100:150] = True  # of the back alone
    assert np.array_equal(first[seen], found[seen])
    assert (then[seen] != found[seen]).any()
    assert np.array_equal(first[215:245, 370:400], then[215:245, 370:400])
    lines = np.full_like(drawn[0], 255)
    one = studio.evaluate(ASK, encoded(drawn[0], lines))
    assert {"code": "no_lines", "layer": "Layer 1"} in one["findings"]
    assert np.array_equal(
        decoded(one, lines.shape), decoded(studio.evaluate(ASK, encoded(drawn[0])), lines.shape)
    )


@pytest.mark.parametrize(
    "area",
    [
        {"points": [130, 50, 210, 50, 210, 130, 130, 130], "normal": [0.6, 0.0, 0.8]},
        {"points": [130, 70, 170, 90, 210, 110], "normal": [0.0, -0.6, 0.8], "size": 40},
        {"points": [130, 70, 210, 110], "normal": [0.0, -0.6, 0.8], "size": 50, "soft": 1.0, "strength": 0.6},
        {"points": [60, 100, 190, 40], "normal": [0.0, 0.0, 1.0], "size": 90, "soft": 0.2, "smooths": True},
        {
            "points": [60, 60, 130, 150, 200, 60],
            "normal": [0.0, 0.0, 1.0],
            "size": 20,
            "height": -0.7,
            "widths": [10, 24, 14],
        },
        *(
            {
                "points": [130, 50, 210, 50, 210, 130, 130, 130],
                "normal": [0.0, 0.0, 1.0],
                "form": {"kind": kind, "bevel": bevel, "strength": 0.9},
                "soft": 0.3,
            }
            for kind, bevel in [("round", 1), ("round", 0.4), ("flat", 0.3), ("hollow", 1)]
        ),
        *(
            {**STROKE, "structure": {"kind": "scales", "period": period, **more}}
            for period, more in [(150, {}), (40, {"turn": 0.7, "x": 31.5, "y": 8.0, "flipped": True})]
        ),
        {**STROKE, "structure": {"kind": "own", "period": 60, "picture": "ribs"}},
    ],
    ids=[
        "region",
        "direction brush",
        "soft brush",
        "smooth",
        "engraved",
        "round",
        "partly round",
        "flat",
        "hollow",
        "structure",
        "turned structure",
        "structure of a picture",
    ],
)
def test_regions_and_the_direction_brush_turn_what_python_turns(studio: "Page", area: dict[str, Any]) -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    predicted = blob_in_python()
    ribs = np.rint(127.5 + 120 * np.sin(np.arange(TILE_SIDE) * 2 * np.pi * 4 / TILE_SIDE)).astype(np.uint8)
    picture = cv2.imencode(".png", np.broadcast_to(ribs, (TILE_SIDE, TILE_SIDE)))[1].tobytes()
    # Two strokes of one structure that cross are one.
    areas = [area, *([{**area, "points": [100, 140, 160, 40]}] if "structure" in area else [])]
    more = {"areas": areas, "structures": {"ribs": base64.b64encode(picture).decode()}}
    request = DrawingRequest.of(parse(DrawingFields, json.dumps(more).encode()), grey[..., None])
    edited = request.edit(predicted.extended, predicted.mask, grey.shape)
    turned = np.abs(edited - predicted.extended).max(-1) > 0.1
    assert turned.sum() > 1500  # or it would be no test
    found = decoded(studio.evaluate(ASK, [*encoded(as_rgba(grey)), more]), grey.shape)
    assert_near(found, replace(predicted, extended=edited), share=0.98, degrees=2)
    if "structure" in area:  # which is finer than what differs else
        part = turned & predicted.mask & (found[..., 3] > 127)
        wanted = replace(predicted, extended=edited, mask=part)
        assert_near(found * part[..., None], wanted, share=0.98, degrees=3)


@pytest.mark.parametrize("down", [False, True])
def test_an_exported_png_is_the_map_with_a_soft_edge(studio: "Page", down: bool) -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    wish = {"what": "map", "format": "png8", "name": "fox", "alpha": True, "y": "down" if down else "up"}
    answer = studio.evaluate(ASK, [*encoded(grey), wish, "/api/export"])
    assert answer["status"] == 200
    found = np.asarray(Image.open(io.BytesIO(base64.b64decode(answer["rgba"]))))
    wanted = python()(grey)
    file = cv2.cvtColor(levels(wanted.encode(y="down" if down else "up", alpha=True)), cv2.COLOR_BGRA2RGBA)
    alike = np.abs(found[..., 3].astype(int) - file[..., 3])
    assert alike.mean() < 1
    assert ((found[..., 3] > 8) & (found[..., 3] < 247)).sum() > 150  # soft
    inside = (found[..., 3] > 250) & (file[..., 3] > 250)
    assert np.abs(found[..., :3].astype(int) - file[..., :3])[inside].mean() < 2
    padded = (file[..., 3] == 0) & (np.abs(file[..., :3].astype(int) - [128, 128, 255]).max(-1) > 9)
    assert padded.sum() > 2000
    assert np.abs(found[..., :3].astype(int) - file[..., :3])[padded].mean() < 9


def test_an_exported_png_of_16_bits_has_the_levels_that_python_writes(studio: "Page") -> None:
    chance = np.random.default_rng(0)
    normals = chance.normal(size=(40, 56, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals[0, :2] = [[0, 0, 1], [1, 0, 0]]
    mask = chance.random((40, 56)) > 0.3
    alpha = np.rint(255 * np.where(mask, chance.random((40, 56)), 0)).astype(np.float32) / np.float32(255)
    predicted = NormalMap(normals, mask, alpha, np.zeros((8, 8), np.float32), None, ())
    depths: tuple[Bits, Bits] = (8, 16)
    for bits, down, transparent in itertools.product(depths, (False, True), (False, True)):
        answer = studio.evaluate(
            """async ([normals, mask, alpha, width, height, down, bits]) => {
              const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
              const floats = (text) => new Float32Array(bytes(text).buffer);
              const { encodePng, levelsOf } = await import("./page/png.js");
              const levels = levelsOf(floats(normals), bytes(mask), alpha && floats(alpha), down, bits);
              const file = await encodePng(levels, width, height, bits);
              let text = "";
              for (const byte of new Uint8Array(await file.arrayBuffer())) text += String.fromCharCode(byte);
              return btoa(text);
            }""",
            [
                base64.b64encode(normals.tobytes()).decode(),
                base64.b64encode(mask.astype(np.uint8).tobytes()).decode(),
                base64.b64encode(alpha.tobytes()).decode() if transparent else None,
                56,
                40,
                down,
                bits,
            ],
        )
        files = (
            base64.b64decode(answer),
            predicted.encode("png", bits, "down" if down else "up", transparent, pad=0),
        )
        found, wanted = map(levels, files)
        assert found.dtype == (np.uint8 if bits == 8 else np.uint16)
        assert np.array_equal(found, wanted), (bits, down, transparent)


def test_a_map_is_exported_with_16_bits(studio: "Page") -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    wish = {"what": "map", "format": "png16", "name": "fox", "alpha": True, "y": "up"}
    answer = studio.evaluate(ASK, [*encoded(grey), wish, "/api/export"])
    assert answer["status"] == 200
    found = levels(base64.b64decode(answer["rgba"]))
    assert found.dtype == np.uint16
    wanted = levels(python()(grey).encode("png", 16, "up", alpha=True))
    inside = (found[..., 3] > 64000) & (wanted[..., 3] > 64000)
    assert inside.sum() > 5000
    assert np.abs(found.astype(int) - wanted)[..., :3][inside].mean() < 2 * 257
    assert len(np.unique(found[..., :3])) > 5000  # and not 256 levels, widened


@pytest.mark.parametrize("count", [1, 6])
def test_points_are_suggested_where_python_suggests_them(studio: "Page", count: int) -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    grey[60:200, 140:143] = 0  # a crease, which points keep off
    predicted = python()(grey)
    taken = [{"x": 170, "y": 90, "normal": [0, 0, 1]}]
    assert predicted.confidence is not None
    # On the same map, the same points.
    given = [predicted.extended, predicted.confidence]
    found = studio.evaluate(
        """async ([normals, confidence, mask, lines, width, height, taken, count]) => {
          const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
          const floats = (text) => new Float32Array(bytes(text).buffer);
          const { suggest } = await import("./page/suggest.js");
          const map = { normals: floats(normals), mask: bytes(mask), width, height };
          return suggest(map, floats(confidence), taken, count, bytes(lines));
        }""",
        [
            *(base64.b64encode(np.ascontiguousarray(each, np.float32).tobytes()).decode() for each in given),
            *(
                base64.b64encode(each.astype(np.uint8).tobytes()).decode()
                for each in (predicted.mask, grey < 128)
            ),
            grey.shape[1],
            grey.shape[0],
            taken,
            count,
        ],
    )
    where = np.array([[170, 90]], np.float32)
    wanted = suggest(predicted.extended, predicted.mask, predicted.confidence, where, count, grey < 128)
    assert len(found) == len(wanted) == count
    for one, other in zip(found, wanted, strict=True):
        assert np.hypot(one["x"] - other.x, one["y"] - other.y) < 3
        assert one["gain"] == pytest.approx(other.gain, abs=0.02)
        assert np.abs(np.subtract(one["normal"], other.normal)).max() < 0.1
    # And of a drawing, points on its object, the best first.
    answer = studio.evaluate(ASK, [*encoded(grey), {"count": count, "hints": taken}, "/api/suggest"])
    points = json.loads(base64.b64decode(answer["rgba"]))["points"]
    assert len(points) == count
    assert all(predicted.mask[int(each["y"]), int(each["x"])] for each in points)
    assert all(grey[int(each["y"]), int(each["x"])] > 127 for each in points)
    assert points[0]["gain"] == max(each["gain"] for each in points)


def test_hints_off_the_object_are_told_as_python_tells_them(studio: "Page") -> None:
    grey = np.rint(255 * (1 - outline(blob((SIDE, SIDE), (250, 260), 120), 3))).astype(np.uint8)
    on = {"x": 250, "y": 260, "normal": [0, 0, 1]}
    hints = [on, *({**on, "x": x, "y": 9} for x in (7, 30, 60, 90))]
    (wanted,) = python()(grey, hints=hints).findings
    (said,) = studio.evaluate(ASK, [*encoded(grey), {"hints": hints}])["findings"]
    assert (said["code"], said["count"], said["total"]) == (wanted.code, wanted.count, wanted.total)
    assert [tuple(place) for place in said["places"]] == list(wanted.places)
    answer = studio.evaluate(ASK, [*encoded(grey), {"hints": [{**each, "reach": 40} for each in hints]}])
    assert not answer["findings"]  # they are no hints, but held to by hand


def test_where_the_model_is_unsure_is_told(studio: "Page") -> None:
    grey = np.rint(255 * (1 - outline(blob()))).astype(np.uint8)
    answer = studio.evaluate(ASK, [*encoded(grey), {}, "/api/uncertainty"])
    shares = np.frombuffer(base64.b64decode(answer["rgba"]), np.uint8).reshape(grey.shape)
    predicted = python()(grey)
    assert predicted.confidence is not None
    wanted = np.where(predicted.mask, 255 * uncertainty(predicted.confidence), 0)
    assert np.abs(shares - wanted)[predicted.mask].mean() < 3
    assert shares[predicted.mask].std() > 1


def test_painted_areas_have_their_outline(studio: "Page") -> None:
    assert_alike(studio, np.rint(255 * (1 - blob())).astype(np.uint8), [], share=0.95, degrees=6)


PREPARE = """async ([drawing, width, height, channels, widths, read]) => {
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const { prepare } = await import("./page/prepare.js");
  const plane = { pixels: bytes(drawing), width, height, channels };
  const reader = async () => new Float32Array(bytes(read).buffer);
  const { seen, ink } = await prepare(plane, 256, "model", null, widths, reader);
  const text = (floats) => {
    let letters = "";
    for (const byte of new Uint8Array(new Float32Array(floats).buffer)) letters += String.fromCharCode(byte);
    return btoa(letters);
  };
  return [text(seen), text(ink)]; // a list of numbers crosses to Python at some ten thousand a second
}"""


@pytest.mark.parametrize(
    ("kind", "most"), [("wide lines", 16), ("areas", 80), ("areas and lines", 80), ("blots", 16)]
)
def test_the_network_is_shown_what_python_shows_it(studio: "Page", kind: str, most: int) -> None:
    rng = np.random.default_rng(sorted(kind.encode()))
    for side, widths in ((256, (0.5, 5.0)), (700, (0.8, 1.9)), (320, (0.5, 5.0)), (512, (0.8, 1.9))):
        grey = random_drawing(kind, rng, side)
        wanted = prepare(as_picture(grey), 256, MODEL, line_widths=widths, clean_strokes=True)
        seen, _ = map(floats, studio.evaluate(PREPARE, [*encoded(grey), list(widths), ""]))
        assert wanted.model_input.max() > 0.9
        # A level on a threshold may round to either side of it.
        assert (np.abs(seen.reshape(wanted.model_input.shape) - wanted.model_input) > 0.02).sum() <= most


@pytest.mark.parametrize("kind", ["wide lines", "areas"])
def test_the_ink_of_a_picture_is_what_python_finds(studio: "Page", kind: str) -> None:
    rgba = as_rgba(random_drawing(kind, np.random.default_rng(2), 320))
    reading = read(as_picture(rgba))
    shares = np.clip(np.stack([reading.ink, reading.presence]).astype(np.float64), 1e-12, 1 - 1e-12)
    logits = np.log(shares / (1 - shares)).astype(np.float32).tobytes()
    answer = studio.evaluate(PREPARE, [*encoded(rgba), [0.5, 5.0], base64.b64encode(logits).decode()])
    _, ink = map(floats, answer)
    wanted = reading.ink_at(as_picture(rgba))
    assert wanted.max() > 0.9
    assert np.abs(ink.reshape(wanted.shape) - wanted).max() < 0.02


def floats(answer: str) -> NDArray[np.float32]:
    """Return the numbers that the page has sent as the text of their bytes."""
    return np.frombuffer(base64.b64decode(answer), np.float32)


def random_drawing(kind: str, rng: np.random.Generator, side: int) -> NDArray[np.uint8]:
    """Return a drawing (H, W) of polygons: outlined, filled, or with a round blot inside."""
    grey = np.full((side, side), 255, np.uint8)

    def polygon(corners: int, radius: float) -> NDArray[np.int32]:
        angles, reach = np.sort(rng.uniform(0, 2 * np.pi, corners)), radius * rng.uniform(0.5, 1, corners)
        points = side / 2 + np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)
        return points.astype(np.int32)

    thin, wide = int(rng.integers(1, 4)), int(side * rng.uniform(0.025, 0.05))
    if "areas" in kind:
        predict = int(rng.integers(0, 140))
        cv2.fillPoly(grey, [polygon(9, 0.3 * side)], (predict,), cv2.LINE_AA)
    if "lines" in kind or kind == "blots":
        line = wide if "wide" in kind else thin
        cv2.polylines(grey, [polygon(12, 0.45 * side)], True, (0,), line, cv2.LINE_AA)
    if kind == "blots":
        cv2.circle(grey, (side // 2, side // 2), int(side * rng.uniform(0.01, 0.2)), (0,), -1, cv2.LINE_AA)
    return grey


def encoded(*layers: NDArray[np.uint8]) -> list[Any]:
    """Return a drawing as the page is given it, the hindmost layer first: grey strokes or RGBA pictures."""
    whole = b"".join(each.tobytes() for each in layers)
    height, width, *channels = layers[0].shape
    return [base64.b64encode(whole).decode(), width, height, *(channels or [1])]


def as_rgba(grey: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a grey drawing as an imported picture (H, W, 4)."""
    return np.dstack([grey, grey, grey, np.full_like(grey, 255)])


def levels(file: bytes) -> NDArray[Any]:
    """Return what a PNG holds, blue first."""
    found = cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_UNCHANGED)
    assert found is not None
    return found


def decoded(answer: dict[str, Any], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return the map (H, W, 4) in an answer."""
    assert answer["status"] == 200, answer["findings"]
    return np.frombuffer(base64.b64decode(answer["rgba"]), np.uint8).reshape(*shape, 4)


def assert_alike(
    page: "Page",
    grey: NDArray[np.uint8],
    hints: list[dict[str, Any]],
    share: float = 0.98,
    degrees: float = 1,
) -> None:
    """Assert that the page paints nearly the mask and the normals that Python paints."""
    found = decoded(page.evaluate(ASK, [*encoded(grey), {"hints": hints}]), grey.shape)
    assert_near(found, of_strokes(grey, hints), share, degrees)


def of_strokes(grey: NDArray[np.uint8], hints: list[dict[str, Any]] | None = None) -> NormalMap:
    """Return the map of strokes (H, W), whose pixels are the ink as they are."""
    model = python()
    picture = as_picture(grey)
    points, widths = as_hints(hints or None, picture.shape), model.backend.line_widths
    prepared = prepare(picture, model.size, hints=points, line_widths=widths, clean_strokes=True)
    return predict(model.backend, prepared, model.upsample)


def assert_near(found: NDArray[np.uint8], wanted: NormalMap, share: float, degrees: float) -> None:
    """Assert that a map (H, W, 4) of the page has nearly the mask and the normals of Python's."""
    mask = found[..., 3] > 127
    both = mask & wanted.mask
    assert both.sum() > share * (mask | wanted.mask).sum()
    normals = found[..., :3].astype(np.float64) / 127.5 - 1
    cosine = (normals * wanted.extended).sum(-1) / np.linalg.norm(normals, axis=-1)
    assert np.degrees(np.arccos(np.clip(cosine[both], -1, 1))).mean() < degrees


def test_a_drawing_is_painted_saved_and_exported(studio: "Page") -> None:
    box = studio.locator("#board").bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    for i in range(41):
        angle = 2 * np.pi * i / 40
        at = middle[0] + 150 * np.cos(angle), middle[1] + 150 * np.sin(angle)
        studio.mouse.move(*at)
        if i == 0:
            studio.mouse.down()
    studio.mouse.up()
    studio.wait_for_function(
        "() => Number(document.getElementById('result').dataset.painted ?? 0) > 0"
        " && document.getElementById('result').ariaBusy === 'false'",
        timeout=120_000,
    )
    studio.locator("#save").click()
    studio.locator("#name-field").fill("ring")
    studio.locator("#save-dialog button.strong").click()
    studio.wait_for_function("() => document.getElementById('status').textContent.includes('ring')")
    assert [each["name"] for each in studio.evaluate("fetch('/api/projects').then((a) => a.json())")] == [
        "ring"
    ]
    refused = studio.evaluate("fetch('/api/height', {method: 'POST'}).then((a) => a.json())")
    assert "needs Python" in refused["error"]


def test_what_needs_python_cannot_be_chosen(studio: "Page") -> None:
    what = studio.locator("#export-what option:not([disabled])")
    assert what.evaluate_all("all => all.map((each) => each.value)") == ["map", "lit", "lines", "colours"]
    studio.evaluate("document.getElementById('export-what').value = 'map'")
    studio.evaluate("document.getElementById('export-what').dispatchEvent(new Event('change'))")
    formats = studio.locator("#export-format option:not([disabled])")
    assert formats.evaluate_all("all => all.map((each) => each.value)") == ["png8", "png16"]


def test_a_picture_that_is_too_narrow_for_a_drawing_is_refused_as_by_the_server(studio: "Page") -> None:
    told = studio.evaluate(
        """async () => {
          const canvas = Object.assign(document.createElement("canvas"), { width: 4096, height: 20 });
          const body = await new Promise((resolve) => canvas.toBlob(resolve));
          return (await fetch("/api/import", { method: "POST", body })).json();
        }"""
    )
    assert told["error"] == "the picture is 2048 × 10 pixels; the studio accepts 16 to 2048 a side."


def test_a_picture_that_is_cut_off_is_refused(studio: "Page") -> None:
    whole = cv2.imencode(".png", mug())[1].tobytes()
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="64" height="64"><path d="M9 9h40v40z"/></svg>'
    told = [
        studio.evaluate(
            """async (given) => {
              const bytes = Uint8Array.from(atob(given), (letter) => letter.charCodeAt(0));
              const body = new Blob([bytes], { type: bytes[0] === 60 ? "image/svg+xml" : "image/png" });
              return (await fetch("/api/import", { method: "POST", body })).json();
            }""",
            base64.b64encode(content).decode(),
        )
        for content in (whole, svg, whole[: len(whole) // 2])
    ]
    assert "error" not in told[0]
    assert "error" not in told[1]
    assert told[2]["error"] == "the picture is cut off or damaged. Use another copy of it."


def test_refusals_are_in_the_language_of_the_page_and_the_relief_is_not_offered(
    built: Path, tmp_path: Path
) -> None:
    with (
        browser(webgl=False) as opened,
        serve(built.parent) as address,
        storage(opened, width=1200, height=700, locale="de-DE") as context,
    ):
        page = context.new_page()
        page.add_init_script("localStorage.setItem('normalgan-view', 'relief')")  # of an earlier visit
        page.goto(f"{address}/{built.name}/")
        page.wait_for_selector("html[data-ready]", timeout=120_000)
        assert page.locator("#view-relief").is_disabled()
        page.keyboard.press("5")
        assert page.locator("#view-map").get_attribute("aria-selected") == "true"
        (tmp_path / "a.psd").write_bytes(b"8BPS")
        page.set_input_files("#import-file", files=tmp_path / "a.psd")
        page.locator("#problem", has_text="dieser Browser kann das Bild nicht lesen").wait_for()
        refused = page.evaluate("fetch('/api/height', {method: 'POST'}).then((a) => a.json())")
        assert "braucht Python" in refused["error"]


def test_it_opens_again_without_a_network(built: Path) -> None:
    with browser(webgl=False) as opened, storage(opened, width=1200, height=700) as context:
        with serve(built.parent) as address:
            page = context.new_page()
            page.goto(f"{address}/{built.name}/")
            page.evaluate("navigator.serviceWorker.ready.then(() => true)")
        page.reload()  # nothing serves it any more
        page.wait_for_selector("html[data-ready]", timeout=120_000)
        assert page.evaluate("crossOriginIsolated")  # so that its network may use threads
        page.locator("#samples button").first.click()
        page.wait_for_function("() => document.getElementById('result').dataset.painted")


def test_the_runtime_is_fetched_and_unpacked_once_for_all_networks(built: Path) -> None:
    asked: list[str] = []
    with serve(built.parent) as address, browser(webgl=False) as opened:
        context = opened.new_context(service_workers="block")  # it fetches every file for later
        context.on("request", lambda each: asked.append(each.url.rpartition("/")[2]))
        page = context.new_page()
        page.goto(f"{address}/{built.name}/")
        page.wait_for_selector("html[data-ready]", timeout=120_000)
        context.close()
    assert asked.count("ours.onnx") == asked.count("reader.onnx") == 1
    assert sum(each.endswith(".packed") for each in asked) == 1


def test_without_npm_the_page_says_what_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hook = runpy.run_path(str(ROOT / "tools" / "site" / "static_studio.py"))
    monkeypatch.setitem(hook["on_post_build"].__globals__, "CACHE", tmp_path / "none")
    monkeypatch.setenv("PATH", "")
    hook["on_post_build"](type("Config", (), {"site_dir": str(tmp_path)}))
    assert "normalgan studio" in (tmp_path / hook["FOLDER"] / "index.html").read_text(encoding="utf-8")
