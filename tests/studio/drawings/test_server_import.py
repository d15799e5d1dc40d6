"""The studio's server reads the layers of a file, each as a picture with its place, or says why it cannot."""

import base64
import io
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from starlette.testclient import TestClient
from studio_client import circle, png, serving

from normalgan.decoding import DecodedLayer
from normalgan.inference.composites.layers import LayeredKind, encode_layers
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import read_picture
from normalgan.studio.drawings.drawing_request import to_picture
from normalgan.studio.drawings.imports import import_picture

SHAPE = (120, 160)
FOX = Path(__file__).parents[3] / "examples" / "sketches" / "fox.png"
KRITA = Path(__file__).parents[2] / "inference" / "composites" / "layered"
PAPER = DecodedLayer("paper", (), 255, 0, 0, 0, 0, np.full((*SHAPE, 4), 255, np.uint8))


def disc(side: int, colour: tuple[int, int, int] = (20, 20, 20)) -> NDArray[np.uint8]:
    """Return a disc (side, side, 4) on nothing."""
    y, x = np.mgrid[:side, :side] + 0.5 - side / 2
    alpha = np.where(np.hypot(x, y) < side / 2, 255, 0)
    return np.dstack([*(np.full_like(alpha, each) for each in colour), alpha]).astype(np.uint8)


def layer(name: str, number: int, left: int, top: int, side: int, **other: int) -> DecodedLayer:
    """Return a layer with a disc on it."""
    frame, opacity = other.get("frame", 0), other.get("opacity", 255)
    return DecodedLayer(name, (), opacity, left, top, number, frame, disc(side))


STACK = [PAPER, layer("body", 1, 30, 40, 64), layer("hat", 2, 50, 10, 30, opacity=102)]


def asked(client: TestClient, content: bytes, way: str = "layers") -> Any:
    headers = {"Content-Type": "application/octet-stream"}
    return client.post(f"/api/import?as={way}", content=content, headers=headers)


def pixels_of(found: dict[str, Any]) -> NDArray[np.uint8]:
    with Image.open(io.BytesIO(base64.b64decode(found["picture"]))) as picture:
        assert picture.mode == "RGBA"
        return np.asarray(picture)


@pytest.mark.parametrize(
    ("form", "pages", "options"),
    [
        *(("TIFF", True, {}), ("GIF", False, {"duration": 90}), ("WEBP", False, {"duration": 90})),
        ("PNG", False, {"duration": 90}),
    ],
)
def test_a_file_of_several_pictures_says_how_many(
    model: Path, tmp_path: Path, form: str, pages: bool, options: dict[str, int]
) -> None:
    every = [Image.fromarray(np.roll(circle(), 9 * i, 1)) for i in range(3)]
    file = io.BytesIO()
    every[0].save(file, form, save_all=True, append_images=every[1:], **options)
    with serving(model, tmp_path) as client:
        found = asked(client, file.getvalue(), "drawing").json()
        single = asked(client, png(circle()), "drawing").json()
        last = asked(client, file.getvalue(), "drawing&part=3").json()
        away = asked(client, file.getvalue(), "drawing&part=4")
        wrong = asked(client, file.getvalue(), "drawing&part=0")
    assert (found["parts"], found["pages"]) == (3, pages)
    differs = np.abs(pixels_of(last)[..., 0].astype(int) - np.roll(circle(), 18, 1))
    assert differs.mean() < 2 < np.abs(pixels_of(found)[..., 0].astype(int) - np.roll(circle(), 18, 1)).mean()
    assert f"no {'page' if pages else 'frame'} 4" in away.json()["error"]
    assert (away.status_code, wrong.status_code) == (400, 400)
    assert 'part is "0"' in wrong.json()["error"]
    assert (single["parts"], single["pages"]) == (1, False)


@pytest.mark.parametrize("kind", ["psd", "ora", "aseprite"])
def test_layers_come_with_their_names_order_opacity_and_places(
    model: Path, tmp_path: Path, kind: LayeredKind
) -> None:
    content = encode_layers(kind, SHAPE, STACK)
    with serving(model, tmp_path) as client:
        one = asked(client, content, "drawing").json()
        found = asked(client, content).json()
        assert not client.post(
            "/api/import", content=png(circle()), headers={"Content-Type": "image/png"}
        ).json()["layered"]
    assert one["layered"]
    assert (found["width"], found["height"], found["given"], found["frames"]) == (160, 120, [160, 120], 1)
    assert found["plain"] == ["paper"]
    assert [(each["name"], each["x"], each["y"], each["width"]) for each in found["layers"]] == [
        ("body", 30, 40, 64),
        ("hat", 50, 10, 30),
    ]
    assert [round(255 * each["opacity"]) for each in found["layers"]] == [255, 102]
    for each, given in zip(found["layers"], STACK[1:], strict=True):
        shown = pixels_of(each)
        assert np.array_equal(shown[..., 3], given.pixels[..., 3])
        assert np.array_equal(shown[shown[..., 3] > 0], given.pixels[given.pixels[..., 3] > 0])


@pytest.mark.parametrize("name", ["krita.kra", "krita.psd"])
def test_files_that_krita_saved_come_in_layers(model: Path, tmp_path: Path, name: str) -> None:
    with serving(model, tmp_path) as client:
        found = asked(client, (KRITA / name).read_bytes()).json()
    assert [(each["name"], each["groups"], each["x"], each["y"]) for each in found["layers"]] == [
        ("body", [], 20, 40),
        ("arm & hand", ["limbs"], 105, 25),
    ]
    assert found["plain"] == ["paper"]


def test_larger_ones_are_made_smaller_together(model: Path, tmp_path: Path) -> None:
    hat = DecodedLayer("hat", (), 255, 1000, 500, 0, 0, disc(400))
    with serving(model, tmp_path) as client:
        found = asked(client, encode_layers("ora", (2048, 4096), [hat])).json()
    assert (found["width"], found["height"], found["given"]) == (2048, 1024, [4096, 2048])
    (only,) = found["layers"]
    assert (only["x"], only["y"], only["width"], only["height"]) == (500, 250, 200, 200)
    assert pixels_of(only).shape == (200, 200, 4)


def test_of_an_animation_the_first_frame_comes_in(model: Path, tmp_path: Path) -> None:
    frames = [layer("hat", 0, 5, 9, 20), layer("hat", 0, 50, 9, 20, frame=1)]
    with serving(model, tmp_path) as client:
        found = asked(client, encode_layers("aseprite", SHAPE, frames, (100, 100))).json()
    assert found["frames"] == 2
    assert [each["x"] for each in found["layers"]] == [5]


def encrypted(content: bytes) -> bytes:
    """Return a ZIP whose files say that they are encrypted."""
    data = bytearray(content)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        places = [each.header_offset + 6 for each in archive.infolist()]
    at = data.find(b"PK\x01\x02")
    while at >= 0:
        places.append(at + 8)
        at = data.find(b"PK\x01\x02", at + 4)
    for place in places:
        data[place] |= 1
    return bytes(data)


ORA = encode_layers("ora", SHAPE, STACK)
REFUSED = {
    "cut off": (ORA[: len(ORA) // 2], "the file is a broken ZIP"),
    "encrypted": (encrypted(ORA), "the file is broken: .*encrypted"),
    "newer": (b"8BPS\0\x09" + encode_layers("psd", SHAPE, STACK)[6:], "the file is a PSD of version 9"),
    "no layers": (png(circle()), "the file has no layers"),
    "paper": (encode_layers("ora", SHAPE, [PAPER]), "the file has no layer with lines"),
    "many": (
        encode_layers("ora", SHAPE, [layer(f"part {i}", i, i, i, 20) for i in range(17)]),
        "the file has 17 visible layers; a drawing has at most 16, so merge or hide some",
    ),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_cannot_come_in_layers_is_said_in_a_sentence(model: Path, tmp_path: Path, kind: str) -> None:
    content, sentence = REFUSED[kind]
    with serving(model, tmp_path) as client:
        answer = asked(client, content)
    assert answer.status_code == 400
    assert re.match(sentence, answer.json()["error"]), answer.text


def test_another_way_to_import_is_refused(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        answer = asked(client, png(circle()), "frames")
    assert answer.status_code == 400
    assert "as is \"frames\"; it should be 'drawing' or 'layers'" in answer.json()["error"]


def test_an_imported_drawing_is_prepared_as_its_file_is() -> None:
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(import_picture(FOX.read_bytes())["picture"]))))
    own, page = (prepare(each, 256).ink for each in (read_picture(FOX), to_picture(pixels)))
    assert (own == page).all()  # to the last bit
