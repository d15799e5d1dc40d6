"""Files of paint programs in the studio's page: their layers become the drawing's, or are one drawing."""

import io
import zipfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest
from PIL import Image
from studio_page import SIDE, OnlyPage, Studio, open_studio, serving

from normalgan.decoding import DecodedLayer
from normalgan.inference.composites.layers import encode_layers
from onnx_models import write_model
from pens import blob, outline

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Request, Route

pytestmark = pytest.mark.slow  # a server and a browser, which take seconds to start
SHAPE = (200, 300)


def part(name: str, number: int, centre: tuple[int, int], radius: int, opacity: int = 255) -> DecodedLayer:
    """Return a disc with a dark rim about a point (x, y), cut to what is opaque in it."""
    filled = blob(SHAPE, centre, radius)
    shade = np.rint(255 * (1 - 0.9 * outline(filled)))
    pixels = np.dstack([shade, shade, shade, 255 * (filled > 0.5)]).astype(np.uint8)
    rows, columns = np.flatnonzero(pixels[..., 3].any(1)), np.flatnonzero(pixels[..., 3].any(0))
    inside = pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    return DecodedLayer(name, (), opacity, int(columns[0]), int(rows[0]), number, 0, inside)


PAPER = DecodedLayer("paper", (), 255, 0, 0, 0, 0, np.full((*SHAPE, 4), 255, np.uint8))
STACK = [
    PAPER,
    part("body", 1, (100, 120), 60),
    part("hat", 2, (200, 60), 40),
    part("note", 3, (40, 40), 20, 0),
]


@pytest.fixture
def studio(only_page: OnlyPage) -> Iterator[Studio]:
    """An empty drawing, and the panel of layers."""
    with only_page.renewed(tolerate=("status of 400",)) as page:
        page.page.locator("#layers-toggle").click()
        page.new()
        yield page


def give(studio: Studio, file: Path, way: str) -> None:
    """Import a file, and choose as what."""
    studio.page.set_input_files("#import-file", files=file)
    studio.page.locator(f"#choose button[value={way}]").click()


def names(studio: Studio) -> list[str]:
    """Return what the layers are called, the front one first."""
    return studio.page.locator("#layer-list .name").all_inner_texts()


def test_the_layers_of_a_file_become_those_of_the_drawing(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "fox.ora"
    file.write_bytes(encode_layers("ora", SHAPE, STACK))
    said = "Imported “fox.ora”: 3 layers. Skipped layers without lines: “paper”."
    with studio.repainting(), studio.saying(said, whole=True):
        give(studio, file, "layers")
    assert names(studio) == ["note", "hat", "body"]
    assert studio.page.locator("#pixels").inner_text() == "300 × 200"
    studio.size = SHAPE[::-1]
    # What has no opacity in the file is hidden here.
    assert studio.page.locator("#layer-list li.unseen .name").all_inner_texts() == ["note"]
    page = studio.page
    for name, x, y in (("body", 100 - 59, 120), ("hat", 200 + 39, 60)):
        page.locator("#layer-list .name", has_text=name).click()
        assert studio.inked(x, y)
    # The hat is there without the body.
    with studio.repainting():
        page.locator("#layer-list li", has_text="body").locator(".eye").click()
    assert studio.shown(200, 60)[2] > 0.9
    assert studio.shown(60, 120)[2] < 0.9
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert names(studio) == ["Layer 1"]
    page.locator("#history summary").click()
    rows = page.locator("#history-list button")
    rows.first.wait_for()
    assert rows.all_inner_texts() == ["Beginning", "Layers imported", "Layer hidden"]


def test_a_layered_file_can_be_one_drawing_or_one_to_trace(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "fox.psd"
    file.write_bytes(encode_layers("psd", SHAPE, STACK[:3]))
    with studio.repainting():
        give(studio, file, "drawing")
    assert names(studio) == ["Layer 1"]
    with studio.saying("Imported “fox.psd”."):  # again
        give(studio, file, "traced")
    assert studio.page.locator("#picture-list li").count() == 1
    assert names(studio) == ["Layer 1"]


def test_exports_and_projects_are_proposed_the_name_of_the_imported_file(
    studio: Studio, tmp_path: Path
) -> None:
    file = tmp_path / "my fox (2).v3.psd"
    file.write_bytes(encode_layers("psd", SHAPE, STACK[:3]))
    with studio.repainting():
        give(studio, file, "layers")
    page = studio.page
    page.locator("#export").click()
    assert page.input_value("#export-name") == "my fox 2 v3"
    studio.dismiss("export")
    page.keyboard.press("Control+s")
    page.locator("#save-dialog[open]").wait_for()
    assert page.input_value("#name-field") == "my fox 2 v3"


def test_a_page_of_a_tiff_can_be_chosen(studio: Studio, tmp_path: Path) -> None:
    pages = [
        Image.fromarray(np.rint(255 * (1 - outline(blob(SHAPE, (x, 90))))).astype(np.uint8))
        for x in (90, 170)
    ]
    pages[0].save(tmp_path / "scan.tiff", save_all=True, append_images=pages[1:])
    with studio.repainting(), studio.saying("Imported “scan.tiff”. Used page 1 of 2.", whole=True):
        give(studio, tmp_path / "scan.tiff", "drawing")
    studio.page.keyboard.press("Control+z")
    studio.page.set_input_files("#import-file", files=tmp_path / "scan.tiff")
    with studio.page.expect_response("**/api/import?part=2"):
        studio.page.locator("#choose input").fill("2")
        studio.page.locator("#choose input").blur()
    with studio.repainting(), studio.saying("Imported “scan.tiff”. Used page 2 of 2.", whole=True):
        studio.page.locator("#choose button[value=drawing]").click()
    assert studio.shown(150, 90)[2] > 0.5


def write_altered(file: Path, old: bytes, new: bytes, without: str = "") -> None:
    """Write an OpenRaster file of two layers with one place in its list of layers changed."""
    with (
        zipfile.ZipFile(io.BytesIO(encode_layers("ora", SHAPE, STACK[1:3]))) as whole,
        zipfile.ZipFile(file, "w") as altered,
    ):
        for name in whole.namelist():
            content = whole.read(name)
            if name == "stack.xml":
                content = content.replace(old, new, 1)
            if name != without:
                altered.writestr(name, content)


def test_layers_that_are_left_out_are_named_with_the_reason(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "fox.ora"
    lost = b'<layer name="lost" src="data/none.png"/><layer name="hat" src="data/none.png"/>'
    write_altered(file, b"<layer", lost + b"<layer")
    said = "Imported “fox.ora”: 2 layers. Skipped damaged layers: “hat”, “lost”."
    with studio.repainting(), studio.saying(said, whole=True):
        give(studio, file, "layers")
    assert studio.page.locator("#problem-words").inner_text() == said
    assert names(studio) == ["hat", "body"]


def test_of_one_drawing_too_it_is_said_what_is_not_shown(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "fox.ora"
    multiplied = b'name="hat" composite-op="svg:multiply"'
    write_altered(file, b'name="hat"', multiplied, without="mergedimage.png")
    said = "Imported “fox.ora”. Effects, masks or blend modes of these layers are not shown: “hat”."
    with studio.repainting(), studio.saying(said, whole=True):
        give(studio, file, "drawing")
    assert studio.page.locator("#problem-words").inner_text() == said


def test_layers_come_in_front_of_what_is_drawn(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "fox.ora"
    file.write_bytes(encode_layers("ora", SHAPE, STACK[1:3]))
    with studio.repainting():
        studio.circle()
    with studio.repainting():
        give(studio, file, "layers")
    assert names(studio) == ["hat", "body", "Layer 1"]
    assert studio.page.locator("#pixels").inner_text() == f"{SIDE} × {SIDE}"
    # As large as fits, in the middle.
    scale = SIDE / SHAPE[1]
    studio.page.locator("#layer-list .name", has_text="body").click()
    assert studio.inked((100 - 59) * scale, 120 * scale + (SIDE - SHAPE[0] * scale) / 2)


def test_a_picture_goes_to_a_layer_of_its_own_where_something_is_drawn(
    studio: Studio, tmp_path: Path
) -> None:
    page = studio.page
    with studio.repainting():
        studio.circle()
    sheet = Image.new("RGB", (SIDE, SIDE), "white")
    sheet.paste("black", (120, 120, 140, 140))
    sheet.save(tmp_path / "sheet.png")
    with studio.saying("Imported “sheet.png”. Working on “Layer 2”."):
        page.set_input_files("#import-file", files=tmp_path / "sheet.png")
        page.locator("#choose button[value=drawing]").click()
    kept = studio.wait_for_server(lambda doc: len(doc["layers"]) == 2)
    assert [[stroke["kind"] for stroke in layer["strokes"]] for layer in kept["layers"]] == [
        ["pen"],
        ["picture"],
    ]
    page.locator("#export").click()
    page.locator("#export-what").select_option("lines")
    with page.expect_download() as waiting:
        page.locator("#export-dialog button.strong").click()
    waiting.value.save_as(tmp_path / "lines.png")
    with Image.open(tmp_path / "lines.png") as lines:
        assert lines.convert("RGB").getpixel((130, 130)) == (0, 0, 0)
        # The paper in front hides no line, as on the board.
        assert lines.convert("RGB").getpixel((SIDE // 2 + 80, SIDE // 2)) == (0, 0, 0)


def test_what_cannot_come_in_layers_is_said_and_nothing_changes(studio: Studio, tmp_path: Path) -> None:
    many = [part(f"part {number}", number, (60 + 9 * number, 90), 30) for number in range(16)]
    files = {
        "paper.ora": ([PAPER], "Couldn't import “paper.ora”: the file has no layer with lines"),
        "many.ora": (many, "“many.ora” has 16 layers; there is room for 15 of at most 16"),
    }
    with studio.repainting():
        studio.circle()
    for name, (layers, words) in files.items():
        (tmp_path / name).write_bytes(encode_layers("ora", SHAPE, layers))
        with studio.saying(words):
            give(studio, tmp_path / name, "layers")
        assert names(studio) == ["Layer 1"]
    (tmp_path / "half.psd").write_bytes(encode_layers("psd", SHAPE, STACK)[:200])
    with studio.saying("Couldn't import “half.psd”: "):
        studio.page.set_input_files("#import-file", files=tmp_path / "half.psd")
    # A layer without lines is imported, with a warning.
    white = DecodedLayer("blank", (), 255, 40, 40, 1, 0, np.full((60, 60, 4), 255, np.uint8))
    (tmp_path / "blank.ora").write_bytes(encode_layers("ora", SHAPE, [STACK[1], white]))
    with studio.repainting():
        give(studio, tmp_path / "blank.ora", "layers")
    assert "blank: No lines found" in studio.page.locator("#warning").inner_text()


def test_a_file_that_the_command_line_names_asks_for_its_layers(opened: "Browser", tmp_path: Path) -> None:
    (tmp_path / "fox.ora").write_bytes(encode_layers("ora", SHAPE, STACK[:3]))
    model = write_model(tmp_path / "ramp.onnx", reach=3)
    with (
        serving(model, tmp_path / "projects", str(tmp_path / "fox.ora")) as server,
        open_studio(opened, server.url) as studio,
    ):
        with studio.repainting():
            studio.page.locator("#choose button[value=layers]").click()
        studio.page.locator("#layers-toggle").click()
        assert names(studio) == ["hat", "body"]


def test_a_file_that_the_command_line_names_asks_for_its_page(opened: "Browser", tmp_path: Path) -> None:
    first, second = Image.new("L", (64, 64), 255), Image.new("L", (80, 48), 255)
    first.save(tmp_path / "scan.tiff", save_all=True, append_images=[second])
    model = write_model(tmp_path / "ramp.onnx", reach=3)
    with (
        serving(model, tmp_path / "projects", str(tmp_path / "scan.tiff")) as server,
        open_studio(opened, server.url) as studio,
    ):
        with studio.saying("Used page 2 of 2."):
            studio.page.locator("#choose input[type=number]").fill("2")
            studio.page.locator("#choose button[value=drawing]").click()
        assert studio.page.locator("#pixels").inner_text() == "80 × 48"


def test_a_small_picture_is_predicted_as_it_is_and_not_enlarged(studio: Studio, tmp_path: Path) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (48, 64, 3), np.uint8)
    pixels[:16] = 255  # most of it is light
    pixels[32:] = 255
    Image.fromarray(pixels).save(tmp_path / "fine.png")
    sent: list[bytes] = []

    def note(request: "Request") -> None:
        if request.url.endswith("/api/predict"):
            sent.append(request.post_data_buffer or b"")

    studio.page.on("request", note)
    with studio.repainting():
        give(studio, tmp_path / "fine.png", "drawing")
    seen = np.frombuffer(sent[0], np.uint8)[-48 * 64 * 4 :].reshape(48, 64, 4)
    assert (seen[..., :3] == pixels).all()
    studio.size = 64, 48
    with studio.repainting():  # what is drawn on it then is seen too
        studio.line((10, 8), (54, 8))
    black = np.array([0, 0, 0, 255], np.uint8).tobytes() * 8
    assert not any(black in each for each in sent[:1])
    assert any(black in each for each in sent)
    studio.page.remove_listener("request", note)


def test_layers_of_more_than_a_request_takes_go_ahead_one_by_one(studio: Studio, tmp_path: Path) -> None:
    # Of a picture four bytes a pixel are sent: 9 MB a layer, where a request takes 20 in all.
    side = 1536
    disc = part("disc", 0, (150, 100), 80).pixels
    layers = [DecodedLayer(name, (), 255, 600 * i, 600, i, 0, disc) for i, name in enumerate(("a", "b", "c"))]
    file = tmp_path / "large.ora"
    file.write_bytes(encode_layers("ora", (side, side), layers))
    page = studio.page
    page.evaluate(
        """() => {
          window.sent = [];
          const ask = window.fetch;
          window.fetch = async (path, options) => {
            const answer = await ask(path, options);
            if (path === "/api/predict") {
              const body = await new Response(options.body).arrayBuffer();
              const length = new DataView(body).getUint32(0, true);
              const text = new TextDecoder().decode(body.slice(4, 4 + length));
              const { layers, longest } = JSON.parse(text);
              const each = layers.map(({ name, bytes }) => [name, bytes]);
              sent.push({ each, longest, size: body.byteLength, status: answer.status });
            }
            return answer;
          };
        }"""
    )
    with studio.repainting():
        give(studio, file, "layers")
    sent = page.evaluate("sent")
    whole = 4 * side * side
    assert [each["each"] for each in sent] == [
        [["a", whole]],
        [["b", whole]],
        [["a", 0], ["b", 0], ["c", whole]],
        [["a", 0], ["b", 0], ["c", 0]],  # each among the others
    ]
    assert [each["longest"] for each in sent] == [64, 64, None, None]
    assert all(each["size"] < 20 * 2**20 and each["status"] == 200 for each in sent)
    studio.size = side, side
    for layer in layers:  # all are in the map
        height, width = layer.pixels.shape[:2]
        assert np.ptp(studio.shown(layer.left + width / 2, layer.top + height / 2)) > 0.2
    # Of what the server has nothing is sent again.
    with studio.repainting():
        page.locator("#layer-list .eye").first.click()
    assert page.evaluate("sent.at(-1).each") == [["a", 0], ["b", 0]]


def test_light_lines_on_nothing_are_shown_dark_which_is_said(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "chalk.png"
    lines = np.rint(255 * outline(blob(SHAPE))).astype(np.uint8)
    Image.merge("LA", (Image.new("L", SHAPE[::-1], 255), Image.fromarray(lines))).save(file)
    with studio.repainting(), studio.saying("Colours inverted, because its lines are light."):
        give(studio, file, "drawing")
    studio.size = SHAPE[::-1]
    assert studio.inked(170, 90 + 60)
    assert not studio.inked(170, 90)


def test_a_file_is_said_to_be_imported_while_it_is_read(studio: Studio, tmp_path: Path) -> None:
    Image.new("L", (SIDE, SIDE), 255).save(tmp_path / "slow.png")
    held: list[Route] = []

    def hold(route: "Route") -> None:
        held.append(route)

    studio.page.route("**/api/import*", hold)
    with studio.saying("Importing “slow.png”…", whole=True):
        studio.page.set_input_files("#import-file", files=tmp_path / "slow.png")
    studio.until(lambda: len(held), bool)
    held[0].continue_()
    studio.page.unroute("**/api/import*")
    studio.page.locator("#choose button[value='']").click()
    studio.until(studio.status, lambda said: said == "")


@pytest.mark.parametrize(("lines", "inverted"), [(245, True), (20, False)])
def test_light_lines_on_a_grey_board_are_shown_dark(
    studio: Studio, tmp_path: Path, lines: int, inverted: bool
) -> None:
    board = np.random.default_rng(0).normal(135, 4, (SIDE, SIDE)).clip(0, 255).astype(np.uint8)
    cv2.circle(board, (SIDE // 2, SIDE // 2), 80, lines, 5, cv2.LINE_AA)
    Image.fromarray(board).save(tmp_path / "board.png")
    said = "Imported “board.png”." + " Colours inverted, because its lines are light." * inverted
    with studio.repainting(), studio.saying(said, whole=True):
        give(studio, tmp_path / "board.png", "drawing")
    assert studio.inked(SIDE / 2 - 80, SIDE / 2)


def test_an_import_that_succeeds_ends_the_message_of_one_that_did_not(studio: Studio, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("milk", encoding="utf-8")
    with studio.saying("Couldn't import “notes.txt”: "):
        studio.page.set_input_files("#import-file", files=tmp_path / "notes.txt")
    file = tmp_path / "fox.ora"
    file.write_bytes(encode_layers("ora", SHAPE, STACK[1:3]))
    with studio.repainting():
        give(studio, file, "drawing")
    studio.page.locator("#status", has_text="Imported “fox.ora”.").wait_for()
    assert studio.page.locator("#problem").is_hidden()


def test_the_lines_of_a_photo_lie_over_the_result_without_its_paper(studio: Studio, tmp_path: Path) -> None:
    paper = np.where(np.arange(SIDE) > SIDE / 2, 110, 190)[None, :, None] + np.array([-20, 0, 20])
    photo = np.broadcast_to(paper, (SIDE, SIDE, 3)).astype(np.uint8).copy()
    cv2.circle(photo, (SIDE // 2, SIDE // 2), 60, (40, 30, 30), 6, cv2.LINE_AA)
    Image.fromarray(photo).save(tmp_path / "photo.png")
    page = studio.page
    with studio.repainting():
        give(studio, tmp_path / "photo.png", "drawing")
    places = [(SIDE / 2 - 30, SIDE / 2), (SIDE / 2 + 30, SIDE / 2)]
    line = SIDE / 2, SIDE / 2 - 60
    plain = [studio.shown(*place) for place in [*places, line]]
    page.keyboard.press("o")
    for place, before in zip(places, plain, strict=False):
        np.testing.assert_allclose(studio.shown(*place), before, atol=0.06)
    assert studio.shown(*line).max() < plain[2].max() - 0.5
    page.keyboard.press("e")
    with studio.repainting():
        studio.line((SIDE / 2, SIDE / 2 - 70), (SIDE / 2, SIDE / 2 - 50))
    assert studio.shown(*line).max() > 0  # erased there too


def test_the_eraser_leaves_the_paper_of_a_photo(studio: Studio, tmp_path: Path) -> None:
    paper = np.linspace(120, 190, SIDE)[None, :, None] + np.array([-20, 0, 20])  # in a shadow on the left
    photo = np.broadcast_to(paper, (SIDE, SIDE, 3)).astype(np.uint8).copy()
    for x in (60, 190):
        cv2.circle(photo, (x, SIDE // 2), 40, (40, 30, 30), 6, cv2.LINE_AA)
    Image.fromarray(photo).save(tmp_path / "photo.png")
    with studio.repainting():
        give(studio, tmp_path / "photo.png", "drawing")
    page = studio.page
    page.keyboard.press("e")
    for x in (60, 190):
        with studio.repainting():
            studio.line((x, SIDE / 2 - 60), (x, SIDE / 2 - 20))
    page.mouse.move(2, 2)
    shown = studio.screen()
    for x in (60, 190):
        column, row = studio.on_board(x, SIDE / 2 - 40)
        np.testing.assert_allclose(shown[round(row), round(column)], paper[0, x], atol=12)


def test_a_fill_colours_the_paint_of_a_picture(studio: Studio, tmp_path: Path) -> None:
    sprite = np.zeros((SIDE, SIDE, 4), np.uint8)
    cv2.circle(sprite, (SIDE // 2, SIDE // 2), 60, (255, 255, 255, 255), -1)
    cv2.circle(sprite, (SIDE // 2, SIDE // 2), 60, (0, 0, 0, 255), 6)
    Image.fromarray(sprite).save(tmp_path / "sprite.png")
    with studio.repainting():
        give(studio, tmp_path / "sprite.png", "drawing")
    page = studio.page
    page.keyboard.press("b")
    page.locator("#fill-colour").fill("#ff8800")
    page.mouse.click(*studio.on_board(SIDE / 2, SIDE / 2))
    page.locator("#view-lit").click()
    page.locator("#material-colours").click()
    page.mouse.move(2, 2)
    for x, y in (studio.on_board(SIDE / 2 + 20, SIDE / 2), studio.on_result(SIDE / 2 + 20, SIDE / 2)):
        pixel = round(y), round(x)
        studio.until(partial(orange_at, studio, pixel), bool)
    column, row = studio.on_board(SIDE / 2 + 20, SIDE / 2)
    page.keyboard.press("s")
    for _ in range(2):  # the picture, then the fill under it
        page.mouse.click(column, row)
    page.keyboard.press("Delete")
    page.mouse.move(2, 2)
    assert not orange_at(studio, (round(row), round(column)))
    assert studio.inked(SIDE / 2 - 60, SIDE / 2)  # the picture stays


def orange_at(studio: Studio, pixel: tuple[int, int]) -> bool:
    red, _, blue = studio.screen()[pixel].astype(int)
    return bool(red > blue + 100)
