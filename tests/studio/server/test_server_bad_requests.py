import io
import json
import struct
import time
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from PIL import Image
from starlette.testclient import TestClient
from studio_client import HEIGHT, WIDTH, asking, b64, circle, png, serving

from hostile_pictures import nested, svg
from normalgan.studio import app
from normalgan.studio.drawings.imports import import_picture

JSON = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    from onnx_models import write_model

    folder = tmp_path_factory.mktemp("studio")
    with serving(write_model(folder / "ramp.onnx"), folder) as client:
        yield client


def bomb(width: int, height: int) -> bytes:
    """Return a PNG of a few bytes that says it has many pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(bytes(9999)))
        + chunk(b"IEND", b"")
    )


def jpeg() -> bytes:
    file = io.BytesIO()
    Image.fromarray(circle()).save(file, "JPEG")
    return file.getvalue()


def hint(**fields: Any) -> dict[str, Any]:
    return {"hints": [{"x": 10, "y": 10, "normal": [0, 0, 1], **fields}]}


BLACK = b64(png(np.zeros((HEIGHT, WIDTH), np.uint8)))
WHITE = b64(png(np.full((HEIGHT, WIDTH), 255, np.uint8)))
SMALL = b64(png(np.full((15, 40), 255, np.uint8)))


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"picture": "no base64!"}, 'picture is "no base64!"; it should be valid base64: '),
        ({"picture": "ü"}, "it should be valid base64: "),
        ({"picture": 7}, "picture is 7; it should be a valid bytes."),
        ({"picture": None}, "picture is missing."),
        ({"picture": b64(b"text")}, "the picture is not a PNG."),
        ({"picture": b64(jpeg())}, "the picture is not a PNG."),
        ({"picture": b64(png(circle())[:200])}, "the picture cannot be read as an image"),
        ({"picture": b64(bomb(60000, 60000))}, "the picture is 60000 × 60000 pixels; the studio accepts 16"),
        ({"picture": b64(bomb(2048, 2048))}, "the picture cannot be read as an image"),
        ({"picture": SMALL}, "the picture is 40 × 15 pixels"),
        ({"picture": WHITE}, "no lines were found in it"),
        ({"mask": SMALL}, "the mask is 40 × 15 pixels"),
        ({"mask": b64(png(np.full((50, 50), 255, np.uint8)))}, "the mask is 50 × 50 pixels, but its sketch"),
        ({"mask": BLACK}, "the mask is empty"),
        ({"source": "sky"}, "source is \"sky\"; it should be 'outline' or 'model'."),
        ({"source": ["model"]}, "source is"),
        ({"tab": ""}, "tab is"),
        ({"tab": 5}, "tab is 5; it should be a valid string."),
        ({"number": -1}, "number is -1; it should be greater than or equal to 0."),
        ({"number": True}, "number is true"),
        ({"number": 1.5}, "number is 1.5"),
        ({"number": 10**400}, "number is"),
        ({"hints": None}, "hints is null; it should be a valid array."),
        ({"hints": {"x": 1}}, 'hints is {"x": 1}; it should be a valid array.'),
        ({"hints": [[1, 2]]}, "hints[0] is [1, 2]; it should be an object."),
        (hint(x="1"), 'hints[0].x is "1"; it should be a valid number.'),
        (hint(x=float("nan")), "hints[0].x is NaN; it should be a finite number."),
        (hint(y=float("inf")), "hints[0].y is Infinity; it should be a finite number."),
        (hint(normal=[0, 0, float("nan")]), "hints[0].normal[2] is NaN; it should be a finite number."),
        (hint(normal=[0, 0, 1e308]), "a normal has length 1"),
        (hint(normal=[0, 0, 0]), "a normal has length 1"),
        (hint(normal=[0, 0, -1]), "looks away from the viewer; its z must be 0 or more"),
        (hint(normal=[0, 1]), "hints[0].normal[2] is missing."),
        (hint(x=10**400), "hints[0].x is"),
        (hint(x=WIDTH), "outside its drawing of 160 × 120 pixels"),
        (hint(y=-0.1), "outside its drawing"),
        ({"hints": hint()["hints"] * 201}, "; it should have at most 200 items, not 201."),
    ],
)
def test_what_cannot_be_painted_is_told_in_a_sentence(
    client: TestClient, fields: dict[str, Any], sentence: str
) -> None:
    for path in ("/api/predict", "/api/suggest", "/api/height"):
        # By hand, as NaN is no JSON that a client would write.
        answer = client.post(path, content=json.dumps(asking(**fields)), headers=JSON)
        assert answer.status_code == 400
        assert list(answer.json()) == ["error"]
        assert sentence in answer.json()["error"]
        assert "Traceback" not in answer.text
        assert "/tmp" not in answer.text


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        (
            {"what": "song"},
            "what is 'song'; it should be one of 'map', 'all', 'ao', 'curvature', 'height', 'mask', ",
        ),
        ({"what": "relief", "format": "exr"}, "format is 'exr'; it should be one of 'glb', 'obj'."),
        ({"y": "left"}, 'y is "left"'),
        ({"alpha": 1}, "alpha is 1; it should be a valid boolean."),
        ({"size": 8}, "size is 8; it should be greater than or equal to 16."),
        ({"size": 10**6}, "size is 1000000"),
        ({"name": "../../fox"}, "'../../fox' is not a valid name"),
        ({"name": "a\r\nSet-Cookie: b"}, "is not a valid name"),
        ({"name": "CON"}, "no name of a Windows device"),
        ({"name": "lpt1"}, "no name of a Windows device"),
        ({"name": ""}, "name is"),
        ({"name": "x" * 81}, "name is"),
    ],
)
def test_what_cannot_be_exported_is_told_in_a_sentence(
    client: TestClient, fields: dict[str, Any], sentence: str
) -> None:
    answer = client.post("/api/export", json=asking(**fields))
    assert answer.status_code == 400
    assert sentence in answer.json()["error"]


@pytest.mark.parametrize(
    ("count", "sentence"),
    [
        (0, "count is 0; it should be greater than or equal to 1."),
        (21, "count is 21; it should be less than or equal to 20."),
        ("5", 'count is "5"; it should be a valid integer.'),
        (None, "count is null; it should be a valid integer."),
    ],
)
def test_a_count_of_points_is_from_1_to_20(client: TestClient, count: object, sentence: str) -> None:
    answer = client.post("/api/suggest", json=asking(count=count))
    assert (answer.status_code, answer.json()) == (400, {"error": sentence})


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        *((body, "the request is not JSON: ") for body in (b"", b"{", b"\xff\xfe", b"[" * 100_000)),
        (b'{"number": ' + b"9" * 5000 + b"}", "the request is not JSON: number out of range"),
        (b"[1]", "the request is [1]; it should be an object."),
    ],
)
def test_what_is_no_json_is_refused(client: TestClient, body: bytes, sentence: str) -> None:
    answer = client.post("/api/predict", content=body, headers=JSON)
    assert answer.status_code == 400
    assert answer.json()["error"].startswith(sentence)


@pytest.mark.parametrize(
    "kind", ["text/plain", "multipart/form-data", "application/x-www-form-urlencoded", ""]
)
def test_another_type_is_refused(client: TestClient, kind: str) -> None:
    for method, path in (("POST", "/api/predict"), ("PUT", "/api/projects/fox"), ("POST", "/api/import")):
        answer = client.request(
            method, path, content=b"{}", headers={"Content-Type": kind, "If-None-Match": "*"}
        )
        assert answer.status_code == 415
        assert "the body is" in answer.json()["error"]


@pytest.mark.parametrize(
    "content", [b"text", b"", b"<svg", bomb(60000, 60000), bomb(4000, 9), png(circle())[:300]]
)
def test_what_is_no_image_is_not_imported(client: TestClient, content: bytes) -> None:
    answer = client.post("/api/import", content=content, headers={"Content-Type": "image/png"})
    assert answer.status_code == 400
    assert "picture" in answer.json()["error"]


def test_where_there_is_nothing_it_says_so_in_json(client: TestClient) -> None:
    for method, path, status in (
        ("GET", "/nothing", 404),
        ("GET", "/api/nothing", 404),
        ("GET", "/page/nothing.js", 404),
        ("GET", "/api/predict", 405),
        ("POST", "/api/about", 405),
        ("POST", "/page/text/text.js", 405),
        ("PATCH", "/api/projects/fox", 405),
    ):
        answer = client.request(method, path, json={})
        assert answer.status_code == status, path
        assert answer.json()["error"].endswith(".")


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"draft": "yes"}, 'draft is "yes"; it should be a valid boolean.'),
        ({"longest": 15}, "longest is 15; it should be greater than or equal to 16."),
    ],
)
def test_what_only_maps_are_asked_with_is_checked(
    client: TestClient, fields: dict[str, Any], sentence: str
) -> None:
    answer = client.post("/api/predict", json=asking(**fields))
    assert (answer.status_code, answer.json()) == (400, {"error": sentence})


def test_a_failure_of_ours_is_one_sentence_too(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("/secret/path\nlong story")

    monkeypatch.setattr("normalgan.studio.predictions.predictor.finish", fail)
    answer = client.post("/api/predict", json=asking(10, hints=[{"x": 3, "y": 3, "normal": [0, 0, 1]}]))
    assert answer.status_code == 500
    assert answer.json() == {"error": "the server failed: RuntimeError; see the terminal for details."}
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert capsys.readouterr().err == "normalgan: studio: RuntimeError: /secret/path\n"


def test_one_picture_is_imported_at_a_time(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    at_once, most = 0, 0

    def slowly(content: bytes, part: int) -> dict[str, str | int | list[int]]:
        nonlocal at_once, most
        at_once += 1
        most = max(most, at_once)
        time.sleep(0.05)
        at_once -= 1
        return import_picture(content, part=part)

    monkeypatch.setattr(app, "import_picture", slowly)
    kind = {"Content-Type": "image/png"}
    with ThreadPoolExecutor(8) as pool:
        asked = [
            pool.submit(client.post, "/api/import", content=png(circle()), headers=kind) for _ in range(8)
        ]
        assert {each.result().status_code for each in asked} == {200}
    assert most == 1


def test_a_picture_that_crashes_its_decoder_is_told_and_the_studio_goes_on(client: TestClient) -> None:
    bomb = svg(nested("g", 900))
    refused = client.post("/api/import", content=bomb, headers={"Content-Type": "image/svg+xml"})
    assert refused.status_code == 400
    assert refused.json()["error"] == "the picture is nested more than 128 deep; drawings are not."
    assert client.post("/api/predict", json=asking(1, tab="after")).status_code == 200
