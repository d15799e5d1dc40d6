"""Layers: each is painted among the others, and only when something changed; the front hides the back."""

import io
import json
import struct
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from PIL import Image
from starlette.testclient import TestClient
from studio_client import HEIGHT, WIDTH, Pixels, asking, b64, codes, png, serving

from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.pipeline import finish
from normalgan.studio.drawings.limits import MOST_LAYERS
from normalgan.studio.drawings.planes import CONTENT_TYPE


def ring(x: float, y: float = 60, radius: float = 34) -> Pixels:
    """A circle, black on white."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    return np.where(np.abs(np.hypot(columns - x, rows - y) - radius) < 1.3, 0, 255).astype(np.uint8)


def inside(x: float, y: float = 60, radius: float = 34) -> Any:
    """What a circle encloses."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    return np.hypot(columns - x, rows - y) < radius


BACK, FRONT = ring(60), ring(96, 64)


def layer(number: int, name: str, drawn: Pixels, **more: Any) -> dict[str, Any]:
    """A layer with a PNG."""
    return {"id": number, "name": name, "picture": b64(png(drawn)), "hints": [], **more}


def ask(number: int, *layers: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A request about layers."""
    asked = asking(number, layers=list(layers), **more)
    del asked["picture"]
    return asked


def pixels(answer: Any) -> Pixels:
    """The map (H, W, 4) in an answer."""
    assert answer.status_code == 200, answer.text
    return np.frombuffer(answer.content, np.uint8).reshape(HEIGHT, WIDTH, 4)


def sent(client: TestClient, number: int, layers: list[tuple[dict[str, Any], bytes]], **more: Any) -> Any:
    """Send layers as raw pixels."""
    asked = ask(number, *({**fields, "bytes": len(own)} for fields, own in layers), **more)
    text = json.dumps(asked).encode()
    body = struct.pack("<I", len(text)) + text + b"".join(own for _, own in layers)
    return client.post("/api/predict", content=body, headers={"Content-Type": CONTENT_TYPE})


def raw(number: int, name: str, base: int | None, drawn: Pixels | None) -> tuple[dict[str, Any], bytes]:
    """A layer whose pixels are sent, all or none."""
    box = [0, 0, 0, 0] if drawn is None else [0, 0, WIDTH, HEIGHT]
    plane = {"name": "ink", "width": WIDTH, "height": HEIGHT, "channels": 1, "box": box}
    fields = {"id": number, "name": name, "base": base, "hints": [], "planes": [plane]}
    return fields, b"" if drawn is None else drawn.tobytes()


def pinned_layer(part: tuple[dict[str, Any], bytes], hint: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
    """A layer with a hint."""
    return {**part[0], "hints": [hint]}, part[1]


def assert_same_object(opacity: Pixels, wanted: Pixels) -> None:
    """Hold an opacity (H, W) to another one; where two soft edges cross, together they cover more."""
    assert np.abs(opacity.astype(int) - wanted).max() < 64


def test_the_front_hides_the_back(model: Path, tmp_path: Path) -> None:
    # By their forms they are told apart, whatever the network says.
    flat, hollow = ({"form": {"kind": kind, "bevel": 0.9, "strength": 1}} for kind in ("flat", "hollow"))
    with serving(model, tmp_path) as client:
        back, front = (
            pixels(client.post("/api/predict", json=asking(number, picture=b64(png(drawn)), **form)))
            for number, drawn, form in ((1, BACK, flat), (2, FRONT, hollow))
        )
        both = pixels(
            client.post(
                "/api/predict", json=ask(3, layer(1, "Body", BACK, **flat), layer(2, "Head", FRONT, **hollow))
            )
        )
        turned = pixels(
            client.post(
                "/api/predict", json=ask(4, layer(2, "Head", FRONT, **hollow), layer(1, "Body", BACK, **flat))
            )
        )
    assert_same_object(both[..., 3], np.maximum(back[..., 3], front[..., 3]))
    # Away from the soft edges of both.
    rims = np.minimum(BACK, FRONT)
    near = cv2.erode(rims, np.ones((7, 7), np.uint8)) == 0
    far = (back[..., 3] > 0) & (front[..., 3] > 0) & ~near
    assert far.sum() > 500
    assert np.array_equal(both[far], front[far])
    assert np.array_equal(turned[far], back[far])
    assert (back[far] != front[far]).any()


def test_a_layer_is_seen_among_the_others(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        alone = pixels(client.post("/api/predict", json=asking(1, picture=b64(png(FRONT)), source="outline")))
        both = client.post(
            "/api/predict", json=ask(2, layer(1, "Body", BACK), layer(2, "Head", FRONT), source="outline")
        )
        one = np.where(alone[..., 3] > 0, FRONT, np.minimum(BACK, FRONT))
        whole = pixels(client.post("/api/predict", json=asking(3, picture=b64(png(one)), source="outline")))
    # The ramp that this network gives runs over all that it is shown.
    inside = cv2.erode(whole[..., 3], np.ones((9, 9), np.uint8)) == 255
    assert np.abs(pixels(both)[inside].astype(int) - whole[inside]).max() <= 2
    inside &= alone[..., 3] == 255
    assert np.abs(alone[inside].astype(int) - whole[inside]).max() > 8


def test_each_layer_says_for_itself_where_its_object_is(model: Path, tmp_path: Path) -> None:
    def mask(client: TestClient, number: int, *layers: dict[str, Any], **more: Any) -> Any:
        return pixels(client.post("/api/predict", json=ask(number, *layers, **more)))[..., 3]

    with serving(model, tmp_path) as client:
        sources = ("outline", "model")
        back = {source: mask(client, 1, layer(1, "a", BACK), source=source) for source in sources}
        front = {source: mask(client, 2, layer(2, "b", FRONT), source=source) for source in sources}
        assert (front["outline"] != front["model"]).any()
        for number, (one, other) in enumerate((("outline", "model"), ("model", "outline")), 3):
            # That of the request is for layers that have none of their own.
            own = layer(1, "a", BACK, source=one), layer(2, "b", FRONT)
            both = mask(client, number, *own, source=other)
            assert_same_object(both, np.maximum(back[one], front[other]))


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> tuple[list[int], list[int]]:
    """How often the network was asked, and how many maps were made of what it said."""
    asked, made = [], []

    class Counting(OnnxBackend):
        def predict(self, *given: Any) -> Any:
            asked.append(1)
            return super().predict(*given)

    def counting(*given: Any) -> Any:
        made.append(1)
        return finish(*given)

    monkeypatch.setattr("normalgan.studio.predictions.predictor.OnnxBackend", Counting)
    monkeypatch.setattr("normalgan.studio.predictions.predictor.finish", counting)
    return asked, made


def test_only_layers_that_look_different_are_painted_again(
    model: Path, tmp_path: Path, counted: tuple[list[int], list[int]]
) -> None:
    asked, made = counted
    with serving(model, tmp_path) as client:
        asked.clear()  # the first is to warm up
        first = sent(client, 1, [raw(1, "a", None, BACK), raw(2, "b", None, FRONT)])
        assert first.status_code == 200, first.text
        assert (len(asked), len(made)) == (2, 2)  # alone they look the same, and among each other too
        moved = ring(90, 50)
        second = sent(client, 2, [raw(1, "a", 1, None), raw(2, "b", 1, moved)])
        assert (len(asked), len(made)) == (3, 4)  # for each the drawing is another
        hint = {"x": 90, "y": 50, "normal": [0, 0.6, 0.8]}
        pinned = sent(client, 3, [raw(1, "a", 2, None), pinned_layer(raw(2, "b", 2, None), hint)])
        assert (len(asked), len(made)) == (5, 5)
        assert second.content != first.content
        assert pinned.content != second.content
        again = sent(client, 4, [raw(1, "a", 3, None), raw(2, "b", 3, None)])
        assert (len(asked), len(made)) == (5, 5)  # what was painted is remembered
        assert again.content == second.content
        hidden = sent(client, 5, [raw(1, "a", 4, None)])
        alone = sent(client, 6, [raw(1, "a", None, BACK)])
        assert hidden.content == alone.content
        assert sent(client, 7, [raw(1, "a", 2, None), raw(2, "b", 3, None)]).status_code == 409


def test_what_has_changed_can_be_had_first(
    model: Path, tmp_path: Path, counted: tuple[list[int], list[int]]
) -> None:
    _, made = counted
    with serving(model, tmp_path) as client:
        first = sent(client, 1, [raw(1, "a", None, BACK), raw(2, "b", None, FRONT)], changed_only=True)
        assert len(made) == 2  # nothing is known yet
        layers = [raw(1, "a", 1, None), raw(2, "b", 1, ring(90, 50))]
        quick = pixels(sent(client, 2, layers, changed_only=True))
        assert len(made) == 3
        layers = [raw(1, "a", 2, None), raw(2, "b", 2, None)]
        whole = pixels(sent(client, 3, layers))
        assert len(made) == 4
        again = pixels(sent(client, 4, [raw(1, "a", 3, None), raw(2, "b", 3, None)], changed_only=True))
    # Where the back is seen, it is as it was; in front the map is new.
    back = inside(60, radius=28) & ~inside(96, 64, radius=40) & ~inside(90, 50, radius=40)
    front = inside(90, 50, radius=28)
    assert np.array_equal(quick[back], pixels(first)[back])
    assert (quick[back] != whole[back]).any()
    assert np.array_equal(quick[front], whole[front])
    assert np.array_equal(again, whole)  # the newest is taken


def test_a_layer_that_cannot_be_painted_leaves_the_others(model: Path, tmp_path: Path) -> None:
    blank = np.full_like(BACK, 255)
    with serving(model, tmp_path) as client:
        alone = client.post("/api/predict", json=asking(1, picture=b64(png(BACK))))
        found = client.post("/api/predict", json=ask(2, layer(1, "Body", BACK), layer(2, "Head", blank)))
        assert np.array_equal(pixels(found), pixels(alone))
        assert ("Head", "no_lines") in codes(found)
        none = sent(client, 3, [raw(1, "Body", None, blank), raw(2, "Head", None, blank)])
        assert none.status_code == 204
        assert codes(none) == [("Body", "no_lines")]


def test_exports_and_heights_are_of_all_layers(model: Path, tmp_path: Path) -> None:
    layers = layer(1, "Body", BACK), layer(2, "Head", FRONT)
    with serving(model, tmp_path) as client:
        shown = pixels(client.post("/api/predict", json=ask(1, *layers)))
        file = client.post("/api/export", json=ask(2, *layers, what="map", format="png8", name="fox"))
        found = np.asarray(Image.open(io.BytesIO(file.content)))
        inside = shown[..., 3] > 127
        assert np.abs(found[inside].astype(int) - shown[inside, :3]).max() <= 1
        heights = client.post("/api/height", json=ask(3, *layers))
        known = np.isfinite(np.frombuffer(heights.content, "<f4").reshape(HEIGHT, WIDTH))
        assert np.array_equal(known, inside)


@pytest.mark.parametrize(
    ("layers", "sentence"),
    [
        ([], "layers is []; it should have at least 1 item"),
        ([layer(n, "a", BACK) for n in range(MOST_LAYERS + 1)], "it should have at most 16 items"),
        (["a"], 'layers[0] is "a"; it should be an object.'),
        ([layer(1, "a", BACK), layer(1, "b", BACK)], "two layers have the same id."),
        ([layer(-1, "a", BACK)], "layers[0].id is -1; it should be greater than or equal to 0."),
        ([layer(1, "", BACK), layer(2, "b", BACK)], "a layer among others has a name."),
        ([layer(1, "a", BACK), layer(2, "b", BACK[:60])], "the layers have different sizes"),
    ],
)
def test_layers_that_cannot_be_used_are_told_so(
    model: Path, tmp_path: Path, layers: list[Any], sentence: str
) -> None:
    with serving(model, tmp_path) as client:
        answer = client.post("/api/predict", json=ask(1, *layers))
        assert answer.status_code == 400
        assert sentence in answer.json()["error"]


def test_pixels_that_do_not_go_with_the_layers_are_told_so(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        fields, own = raw(1, "a", None, BACK)
        answer = sent(client, 1, [(fields, own + b"more")])
        assert answer.status_code == 400
        assert "there are" in answer.json()["error"]


def test_an_open_edge_that_a_layer_in_front_hides_is_not_told(model: Path, tmp_path: Path) -> None:
    open_ring = ring(60)
    open_ring[:, 76:] = 255
    handle, mug = layer(1, "Handle", open_ring), layer(2, "Mug", ring(56, 46, 24))
    with serving(model, tmp_path) as client:
        hidden = codes(client.post("/api/predict", json=ask(1, handle, mug)))
        seen = codes(client.post("/api/predict", json=ask(2, mug, handle)))
        drawn = [raw(1, "Handle", None, open_ring), raw(2, "Mug", None, ring(56, 46, 24))]
        small, large = (codes(sent(client, 3, drawn, longest=longest)) for longest in (WIDTH // 2, 2 * WIDTH))
    assert ("Handle", "edge") in seen
    for each in (hidden, small, large):
        assert ("Handle", "edge") not in each
