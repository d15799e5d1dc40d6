"""Raw pixels: what is sent again is only what changed, and the map is that of all of it."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient
from studio_client import HEIGHT, WIDTH, Pixels, asking, circle, codes, serving

from normalgan.errors import InputError
from normalgan.studio.drawings.planes import CONTENT_TYPE, KeptPlanes, split_body
from normalgan.studio.drawings.schemas import RequestFields, parse
from normalgan.studio.server.refusals import BehindError

ALL = [0, 0, WIDTH, HEIGHT]


def body(fields: dict[str, Any], *pixels: Pixels) -> bytes:
    text = json.dumps(fields).encode()
    return struct.pack("<I", len(text)) + text + b"".join(each.tobytes() for each in pixels)


def plane(box: list[int], **more: Any) -> dict[str, Any]:
    return {"name": "ink", "width": WIDTH, "height": HEIGHT, "channels": 1, "box": box, **more}


def fields(number: int, base: int | None, box: list[int], **more: Any) -> dict[str, Any]:
    asked = asking(number, base=base, planes=[plane(box)], **more)
    del asked["picture"]
    return asked


def read(*args: Any, **more: Any) -> RequestFields:
    return parse(RequestFields, json.dumps({**fields(*args), **more}).encode())


def sent(client: TestClient, asked: dict[str, Any], *pixels: Pixels) -> Any:
    return client.post("/api/predict", content=body(asked, *pixels), headers={"Content-Type": CONTENT_TYPE})


def test_what_changed_makes_the_same_map_as_all_of_it(model: Path, tmp_path: Path) -> None:
    first, second = circle(), circle()
    second[50:60, 60:80] = 0
    with serving(model, tmp_path) as client:
        whole = sent(client, fields(1, None, ALL), first)
        assert whole.status_code == 200, whole.text
        changed = sent(client, fields(3, 1, [60, 50, 80, 60]), second[50:60, 60:80])
        assert changed.content == sent(client, fields(4, None, ALL), second).content
        nothing = sent(client, fields(5, 4, [0, 0, 0, 0]))
        assert nothing.content == changed.content
        coarse = sent(client, fields(6, 5, [0, 0, 0, 0], longest=80))
        assert (coarse.headers["x-width"], coarse.headers["x-height"]) == ("80", "60")


def test_a_change_of_what_is_not_there_is_told_so(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        assert sent(client, fields(1, 7, [0, 0, 0, 0])).status_code == 409
        assert sent(client, fields(2, None, ALL), circle()).status_code == 200
        assert sent(client, fields(3, 1, [0, 0, 0, 0])).status_code == 409
        assert sent(client, fields(4, 2, [0, 0, 0, 0])).status_code == 200


def test_a_drawing_that_cannot_be_painted_yet_is_no_error(model: Path, tmp_path: Path) -> None:
    blank = np.full_like(circle(), 255)
    with serving(model, tmp_path) as client:
        answer = sent(client, fields(1, None, ALL), blank)
        assert (answer.status_code, answer.content) == (204, b"")
        assert codes(answer) == [("", "no_lines")]
        assert sent(client, fields(2, 1, ALL), circle()).status_code == 200


def test_the_oldest_tabs_planes_are_forgotten() -> None:
    kept = KeptPlanes(most=2)
    pixels = memoryview(circle().tobytes())
    for number, tab in enumerate("abc", 1):
        kept.take(tab, read(number, None, ALL), pixels, number)
    nothing = memoryview(b"")
    kept.take("c", read(4, 3, [0, 0, 0, 0]), nothing, 4)
    with pytest.raises(BehindError, match="send all of it"):
        kept.take("a", read(5, 1, [0, 0, 0, 0]), nothing, 5)
    kept.take("b", read(6, 2, [0, 0, 0, 0]), nothing, 6, keep=False)
    kept.take("b", read(7, 2, [0, 0, 0, 0]), nothing, 7)


@pytest.mark.parametrize(
    ("change", "pixels", "complaint"),
    [
        ({"planes": 3}, 0, "planes is 3"),
        ({"planes": [plane(ALL, name="fox")]}, 0, 'name is "fox"'),
        ({"planes": [plane(ALL, channels=2)]}, 0, "channels is 2; it should be 1 or 4"),
        ({"planes": [plane(ALL, width=4000)]}, 0, "width is 4000; it should be less than or equal to 2048"),
        ({"planes": [plane([0, 0, WIDTH + 1, 9])]}, 0, "left, top, right, bottom"),
        ({"planes": [plane([5, 0, 4, 9])]}, 0, "left, top, right, bottom"),
        ({"planes": [plane(ALL)]}, 5, "there are 5 bytes of pixels; the box of ink has"),
        ({"planes": [plane(ALL)]}, WIDTH * HEIGHT + 1, "the box of ink has"),
        ({"planes": []}, 0, "planes is missing"),
        ({"planes": [plane([0, 0, 2, 2])]}, 4, "send all of it"),
        ({"keep": 3}, WIDTH * HEIGHT, "keep is 3; it should be a valid boolean"),
    ],
)
def test_planes_that_do_not_fit_are_refused(change: dict[str, Any], pixels: int, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        KeptPlanes().take("a", read(1, None, ALL, **change), memoryview(bytes(pixels)), 1)


@pytest.mark.parametrize("cut", [b"", b"\x01", struct.pack("<I", 9) + b"{}"])
def test_a_body_that_is_cut_off_is_refused(cut: bytes) -> None:
    with pytest.raises(InputError, match="is cut off"):
        split_body(cut)
