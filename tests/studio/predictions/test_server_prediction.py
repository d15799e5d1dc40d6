import base64
import io
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path
from threading import Event
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from starlette.testclient import TestClient
from studio_client import (
    CENTRE,
    HEIGHT,
    RADIUS,
    WIDTH,
    Pixels,
    asking,
    away,
    b64,
    circle,
    findings,
    png,
    serving,
)

from normalgan.__main__ import main
from normalgan.inference.cleaning.reader import Reading, read
from normalgan.inference.heights.height import integrate
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.network.upsampling import Coarse, enlarge
from normalgan.inference.reading.picture import Picture
from normalgan.inference.structures import KINDS
from normalgan.normals import decode
from normalgan.studio.drawings.limits import MOST_AREAS, TILE_SIDE
from onnx_models import write_model

SVG = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 30 20"><circle cx="9" cy="9" r="5"/></svg>'


def predicted(client: TestClient, **fields: Any) -> Pixels:
    answer = client.post("/api/predict", json=asking(**fields))
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/octet-stream"
    size = int(answer.headers["x-height"]), int(answer.headers["x-width"])
    assert float(answer.headers["x-seconds"]) > 0
    return np.frombuffer(answer.content, np.uint8).reshape(*size, 4)


def test_it_paints_what_generate_paints(model: Path, tmp_path: Path) -> None:
    (tmp_path / "fox.png").write_bytes(png(circle()))
    out = tmp_path / "out"
    assert (
        main(["generate", str(tmp_path / "fox.png"), "-o", str(out), "--model", str(model), "--alpha"]) == 0
    )
    with Image.open(out / "fox_normal.png") as image:
        truth = np.asarray(image)
    with serving(model, tmp_path / "p") as client:
        pixels = predicted(client)
    assert pixels.shape == truth.shape == (HEIGHT, WIDTH, 4)
    assert np.array_equal(pixels[..., 3], truth[..., 3])
    soft = (pixels[..., 3] > 8) & (pixels[..., 3] < 247)
    assert soft.sum() > 2 * RADIUS  # an edge and no staircase
    inside = pixels[..., 3] == 255
    assert abs(int(inside.sum()) - np.pi * RADIUS**2) < 0.1 * np.pi * RADIUS**2
    assert np.array_equal(pixels[inside][:, :3], truth[inside][:, :3])


def test_a_hint_is_followed_where_it_is(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        free = decode(predicted(client)[..., :3])
        normal = (-0.6, 0.0, 0.8)
        hinted = decode(
            predicted(client, number=2, hints=[{"x": 70.5, "y": 60.5, "normal": normal}])[..., :3]
        )
    before, after = (
        np.degrees(np.arccos(np.clip(each[60, 70] @ np.array(normal), -1, 1))) for each in (free, hinted)
    )
    # The model's pixel at the hint is half again as large as the drawing's, and blends with those about it.
    assert before > 30
    assert after < 15
    changed = np.linalg.norm(hinted - free, axis=-1) > 0.05
    assert changed[60, 70]
    assert np.hypot(*(np.argwhere(changed) - (60, 70)).T).max() < 12


def test_a_mask_says_where_the_object_is(model: Path, tmp_path: Path) -> None:
    mask = np.zeros((HEIGHT, WIDTH), np.uint8)
    mask[40:80, 50:90] = 255
    with serving(model, tmp_path) as client:
        found = predicted(client, mask=b64(png(mask)))[..., 3] > 127
    assert (found != (mask > 127)).sum() <= 4  # its soft edge rounds the corners


def test_the_mask_brush_adds_to_the_object_and_cuts_from_it(model: Path, tmp_path: Path) -> None:
    x, y = CENTRE
    strokes = [
        {"adds": True, "size": 12, "points": [x + RADIUS, y, x + RADIUS + 20, y]},
        {"adds": False, "size": 10, "points": [x, y]},
        {"adds": True, "size": 4, "points": [x, y]},  # the last one counts
    ]
    with serving(model, tmp_path) as client:
        before = predicted(client)[..., 3] > 127
        after = predicted(client, number=2, mask_strokes=strokes)[..., 3] > 127
        assert not before[60, 128]
        assert after[60, 128]
        assert not after[60, 66]
        assert after[60, 70]
        assert np.array_equal(before[:40], after[:40])
        wrong = client.post("/api/predict", json=asking(3, mask_strokes=[{"size": 4, "points": [1, 1]}]))
        assert wrong.status_code == 400
        assert wrong.json()["error"] == "mask_strokes[0].adds is missing."


def test_a_dab_of_the_mask_brush_closes_a_gap_in_the_outline(model: Path, tmp_path: Path) -> None:
    arc = circle()
    arc[45:75, 100:] = 255
    dab = {"adds": True, "size": 36, "points": [CENTRE[0] + RADIUS, CENTRE[1]]}
    with serving(model, tmp_path) as client:
        answer = client.post("/api/predict", json=asking(picture=b64(png(arc)), mask_strokes=[dab]))
        assert findings(answer) == []
        mask = np.frombuffer(answer.content, np.uint8).reshape(HEIGHT, WIDTH, 4)[..., 3] > 127
    inside = away() < RADIUS - 2
    assert mask[inside].mean() > 0.99


def test_a_gap_in_the_outline_hardly_changes_the_object(model: Path, tmp_path: Path) -> None:
    def overlap(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
        return float((a & b).sum() / (a | b).sum())

    opened = circle()
    opened[50:70, 100:] = 255  # the eraser's work, or the begin of an ear
    opened[46:48, 100:140] = 0
    with serving(model, tmp_path) as client:
        closed = predicted(client)[..., 3] > 127
        answer = client.post("/api/predict", json=asking(2, picture=b64(png(opened))))
        found = np.frombuffer(answer.content, np.uint8).reshape(HEIGHT, WIDTH, 4)[..., 3] > 127
        assert overlap(found, closed) > 0.95


def test_a_draft_is_given_up_for_the_map_of_the_whole_stroke(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, go, enlarged = Event(), Event(), []

    def held(self: OnnxBackend, *given: Any) -> Any:
        begun.set()
        assert go.wait(60)
        return network(self, *given)

    def counted(coarse: Coarse, *given: Any) -> Any:
        enlarged.append(coarse)
        return enlarge(coarse, *given)

    network = OnnxBackend.predict
    monkeypatch.setattr("normalgan.inference.network.onnx_backend.upsampler", lambda **_: counted)
    with serving(model, tmp_path) as client, ThreadPoolExecutor(2) as pool:
        monkeypatch.setattr(OnnxBackend, "predict", held)
        draft = pool.submit(client.post, "/api/predict", json=asking(1, draft=True, longest=64))
        assert begun.wait(60)
        whole = pool.submit(client.post, "/api/predict", json=asking(2))
        assert (draft.result(60).status_code, draft.result().content) == (204, b"")
        go.set()
        assert whole.result(60).status_code == 200
        assert len(enlarged) == 1
        # A draft that nothing overtakes is a map as any other.
        assert predicted(client, number=3, draft=True).tobytes() == whole.result().content


def test_a_few_maps_are_kept(model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    enlarged = []

    def counted(coarse: Coarse, *given: Any) -> Any:
        enlarged.append(coarse)
        return enlarge(coarse, *given)

    monkeypatch.setattr("normalgan.inference.network.onnx_backend.upsampler", lambda **_: counted)
    drawings = [b64(png(np.roll(circle(), down, 0))) for down in range(6)]
    with serving(model, tmp_path) as client:
        for number, drawing in enumerate((*drawings, drawings[-2]), 1):
            predicted(client, number=number, picture=drawing)
        assert len(enlarged) == 6
        predicted(client, number=8, picture=drawings[0])
    assert len(enlarged) == 7


def test_the_reader_runs_once_for_all_sizes_and_edits_of_a_picture(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pictures = []

    def counted(picture: Picture) -> Reading:
        pictures.append(picture)
        return read(picture)

    dab = {"adds": True, "size": 20, "points": [CENTRE[0] + RADIUS, CENTRE[1]]}
    other = b64(png(np.roll(circle(), 3, 0)))
    with serving(model, tmp_path) as client:
        edited = predicted(client, mask_strokes=[dab])
    with serving(model, tmp_path) as client:
        monkeypatch.setattr("normalgan.studio.predictions.predictor.read", counted)
        predicted(client, longest=64)
        predicted(client, number=2)
        assert np.array_equal(predicted(client, number=3, mask_strokes=[dab]), edited)
        predicted(client, number=4, source="outline")
        assert len(pictures) == 1
        predicted(client, number=5, picture=other)
    assert len(pictures) == 2


def test_what_is_said_about_a_map_can_be_read_from_its_header(model: Path, tmp_path: Path) -> None:
    arc = circle()
    arc[:, 90:] = 255
    with serving(model, tmp_path) as client:
        request = asking(picture=b64(png(arc)), source="outline")
        answer = client.post("/api/predict", json=request)
        assert findings(client.post("/api/predict", json=asking(2))) == []
    said, *_ = findings(answer)
    assert said["code"] == "guessed"
    assert said["words"].startswith("no object was found among its lines")
    assert " " not in answer.headers["x-findings"]


def test_heights_belong_to_the_map(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        pixels = predicted(client)
        answer = client.post("/api/height", json=asking())
    heights = np.frombuffer(answer.content, "<f4").reshape(HEIGHT, WIDTH)
    inside = pixels[..., 3] > 127
    assert np.array_equal(np.isfinite(heights), inside)
    truth = integrate(decode(pixels[..., :3]), inside)
    assert np.abs(heights - truth)[inside].max() < 0.05 * np.ptp(truth)


def test_points_are_on_the_object_apart_and_away_from_hints(model: Path, tmp_path: Path) -> None:
    with serving(model, tmp_path) as client:
        pixels = predicted(client)
        hints = [{"x": 70, "y": 60, "normal": [0, 0, 1]}]
        points = client.post("/api/suggest", json=asking(count=6, hints=hints)).json()["points"]
    assert 3 <= len(points) <= 6
    at = np.array([(point["x"], point["y"]) for point in points])
    between = np.linalg.norm(at[:, None] - at[None], axis=-1)[~np.eye(len(at), dtype=bool)]
    assert between.min() > 10
    assert np.linalg.norm(at - (70.5, 60.5), axis=1).min() > 10
    for point in points:
        row, column = int(point["y"]), int(point["x"])
        assert pixels[row, column, 3] == 255
        assert np.abs(decode(pixels[row, column, :3]) - point["normal"]).max() < 0.02
    gains = [point["gain"] for point in points]
    assert gains == sorted(gains, reverse=True)
    assert 0 <= gains[-1] <= gains[0] <= 1


@pytest.mark.parametrize(
    ("wish", "options", "name"),
    [
        ({}, [], "fox 2_normal.png"),
        ({"format": "png16", "y": "down"}, ["--bits", "16", "--y", "down"], "fox 2_normal.png"),
        ({"format": "exr", "alpha": True}, ["--format", "exr", "--alpha"], "fox 2_normal.exr"),
        ({"format": "tiff", "size": 90}, ["--format", "tiff", "--size", "90"], "fox 2_normal.tiff"),
        ({"what": "preview", "format": "gif"}, ["--preview", "gif"], "fox 2_preview.gif"),
        ({"what": "height"}, ["--height", "png"], "fox 2_height.png"),
        ({"what": "relief", "format": "glb"}, ["--relief", "glb"], "fox 2_relief.glb"),
    ],
)
def test_an_export_is_the_file_that_generate_writes(
    model: Path, tmp_path: Path, wish: dict[str, Any], options: list[str], name: str
) -> None:
    (tmp_path / "fox 2.png").write_bytes(png(circle()))
    out = tmp_path / "out"
    assert (
        main(["generate", str(tmp_path / "fox 2.png"), "-o", str(out), "--model", str(model), *options]) == 0
    )
    with serving(model, tmp_path / "p") as client:
        answer = client.post("/api/export", json=asking(name="fox 2", **wish))
    assert answer.status_code == 200, answer.text
    assert unquote(answer.headers["content-disposition"]) == f"attachment; filename*=UTF-8''{name}"
    assert answer.content == (out / name).read_bytes()


def test_about_names_the_model_and_the_limits(tmp_path: Path) -> None:
    path = write_model(tmp_path / "sure.onnx", size=32, confidence=False)
    with serving(path, tmp_path / "p") as client:
        about = client.get("/api/about").json()
        assert client.get("/api/open").json() is None
    assert about["model"] == {"name": "sure.onnx", "size": 32, "confidence": False}
    assert about["limits"] == {"side": 2048, "hints": 200, "body": 20 * 2**20}


@pytest.mark.parametrize("kind", ["png", "jpeg", "webp", "svg", "large"])
def test_an_image_of_any_kind_is_imported(model: Path, tmp_path: Path, kind: str) -> None:
    content, size = SVG, (1024, 683)
    if kind != "svg":
        image = Image.fromarray(circle())
        if kind == "large":
            image = image.resize((4096, 96))
        file = io.BytesIO()
        image.save(file, "png" if kind == "large" else kind)
        content, size = file.getvalue(), (2048, 48) if kind == "large" else (WIDTH, HEIGHT)
    with serving(model, tmp_path) as client:
        answer = client.post("/api/import", content=content, headers={"Content-Type": "image/*"})
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert (found["width"], found["height"]) == size
    with Image.open(io.BytesIO(base64.b64decode(found["picture"]))) as picture:
        assert picture.mode == "RGBA"
        assert picture.size == size
        pixels = np.asarray(picture)
    if kind == "svg":
        assert pixels[0, 0, 3] == 0
        assert pixels[307, 307].tolist() == [0, 0, 0, 255]
    else:
        assert (pixels[..., 3] == 255).all()
        if kind != "large":
            assert np.abs(pixels[..., 0].astype(int) - circle()).mean() < 4
            assert pixels[..., 0][np.abs(away() - RADIUS) < 0.5].max() < 120


def test_the_map_at_a_pin_is_the_pins_normal_and_areas_are_turned(model: Path, tmp_path: Path) -> None:
    pins: list[dict[str, Any]] = [
        {"x": 62, "y": 60, "normal": [-1, 0, 0], "reach": 9},
        {"x": 78, "y": 60, "normal": [1, 0, 0]},
        {"x": 70, "y": 80, "normal": [0, 0.6, 0.8], "reach": 4},
    ]
    area: dict[str, Any] = {"points": [40, 40, 60, 40, 60, 50, 40, 50], "normal": [0, -0.6, 0.8]}
    stroke = {"points": [84, 40, 94, 44], "normal": [0, 0, 1], "size": 8}
    with serving(model, tmp_path) as client:
        bare = decode(predicted(client)[..., :3])
        held = decode(predicted(client, number=2, hints=pins, areas=[area, stroke])[..., :3])
        for pin in pins:
            assert np.degrees(np.arccos(min(1, held[pin["y"], pin["x"]] @ np.array(pin["normal"])))) < 1.5
        inside = held[42:48, 44:56].reshape(-1, 3).mean(0)
        assert np.abs(inside / np.linalg.norm(inside) - area["normal"]).max() < 0.05
        assert np.abs(held[42, 89] - [0, 0, 1]).max() < 0.2 < np.abs(bare[42, 89] - [0, 0, 1]).max()
        for wrong in (
            {"areas": 3},
            {"areas": [3]},
            {"areas": [{**area, "points": [1, 2]}]},
            {"areas": [{**area, "normal": [0, 0, -1]}]},
            {"areas": [{**stroke, "strength": 2}]},
            {"areas": [{**stroke, "soft": True}]},
            {"areas": [{**stroke, "smooths": 1}]},
            {"areas": [{**stroke, "structure": "scales"}]},
            {"areas": [{**stroke, "structure": {"kind": "glass", "period": 9}}]},
            {"areas": [{**stroke, "structure": {"kind": "fur"}}]},
            {"areas": [{**stroke, "structure": {"kind": "fur", "period": 1e-9}}]},
            {"areas": [{**stroke, "structure": {"kind": "fur", "period": 9, "x": 1e9}}]},
            {"areas": [{**stroke, "structure": {"kind": "fur", "period": 9}, "smooths": True}]},
            {"areas": [{**area, "structure": {"kind": "fur", "period": 9}}]},
            {"areas": [{**stroke, "structure": {"kind": "own", "period": 9, "picture": "a"}}]},
            {"structures": [1]},
            {"structures": {"a": 1}},
            {"areas": [{**stroke, "height": -2}]},
            {"areas": [{**stroke, "height": "deep"}]},
            {"areas": [{**stroke, "height": 1, "widths": [3]}]},
            {"areas": [{**stroke, "height": 1, "widths": [3, 0]}]},
            {"areas": [stroke] * (MOST_AREAS + 1)},
        ):
            assert client.post("/api/predict", json=asking(3, **wrong)).status_code == 400
        last = {**stroke, "points": [60, 80, 80, 80], "height": 0.5}
        carved = [{**last, "points": [50 + k % 40, 40]} for k in range(2 * MOST_AREAS)]
        (one, many) = (
            decode(predicted(client, number=number, areas=areas)[..., :3])
            for number, areas in ((4, [last]), (5, [stroke] * MOST_AREAS + [*carved, last]))
        )
        assert np.array_equal(many[74:86, 60:80], one[74:86, 60:80])
        assert np.abs(one[78, 70] - bare[78, 70]).max() > 0.1
        far = client.post("/api/predict", json=asking(6, hints=[{**pins[0], "reach": -1}]))
        assert "hints[0].reach is -1" in far.json()["error"]


def test_a_stroke_gives_a_structure_that_is_built_in_or_a_picture(model: Path, tmp_path: Path) -> None:
    stroke = {"points": [50, 60, 100, 60], "normal": [0, 0, 1], "size": 30, "soft": 0.2}
    wave = 127.5 + 120 * np.sin(np.arange(TILE_SIDE) * 2 * np.pi * 4 / TILE_SIDE)
    ribs = np.broadcast_to(wave, (TILE_SIDE, TILE_SIDE))
    own = {"kind": "own", "period": 64, "picture": "ribs"}
    numbers = count(1)
    with serving(model, tmp_path) as client:

        def near(*areas: dict[str, Any], **fields: Any) -> NDArray[np.float32]:
            found = predicted(client, number=next(numbers), areas=list(areas), **fields)
            return np.asarray(decode(found[50:70, 60:90, :3]))

        bare = near()
        for kind in KINDS:
            given = near({**stroke, "structure": {"kind": kind, "period": 64}})
            assert np.abs(given - bare).mean() > 0.04
        one = {**stroke, "structure": {"kind": "stone", "period": 32}}
        crossed = near(one, {**one, "points": [75, 40, 75, 80]})
        assert np.abs(crossed - near(one)).max() < 0.05  # no steeper where strokes cross
        parted = near(one, stroke | {"strength": 0}, one)
        assert np.abs(parted - crossed).max() > 0.05
        pictures = {"ribs": base64.b64encode(png(ribs.astype(np.uint8))).decode()}
        ribbed = near({**stroke, "structure": own}, structures=pictures) - bare
        assert np.abs(ribbed[..., 0]).mean() > 10 * np.abs(ribbed[..., 1]).mean()  # they run upright
        turned = near({**stroke, "structure": {**own, "turn": np.pi / 2}}, structures=pictures) - bare
        assert np.abs(turned[..., 1]).mean() > 10 * np.abs(turned[..., 0]).mean()
        small = {"ribs": base64.b64encode(png(ribs[:64, :64].astype(np.uint8))).decode()}
        fields = asking(next(numbers), areas=[{**stroke, "structure": own}], structures=small)
        answer = client.post("/api/predict", json=fields)
        assert answer.status_code == 400
        assert "a structure is 64 × 64 pixels; it must have 128 a side" in answer.json()["error"]


def test_a_layer_and_a_region_take_a_form(model: Path, tmp_path: Path) -> None:
    form = {"kind": "round", "bevel": 1, "strength": 1}
    area = {"points": [50, 40, 90, 40, 90, 80, 50, 80], "normal": [0, 0, 1]}
    with serving(model, tmp_path) as client:

        def at(x: int, y: int, **fields: Any) -> NDArray[np.float32]:
            normals = decode(predicted(client, number=next(numbers), **fields)[..., :3])
            return np.asarray(normals[y, x], np.float32)

        numbers = count(1)
        x, y = round(CENTRE[0]), round(CENTRE[1])
        right = x + round(0.8 * RADIUS)
        assert at(right, y, form=form)[0] > 0.7 > at(right, y)[0]
        flat = {**form, "kind": "flat", "bevel": 0.2}
        assert at(70, 60, areas=[{**area, "form": flat}])[2] > 0.99
        assert at(52, 60, areas=[{**area, "form": flat}])[0] < -0.4
        # A region alone fades out; with soft 0 it ends at once.
        turned = {**area, "normal": [0, 0.8, 0.6]}
        assert at(52, 60, areas=[{**turned, "soft": 0}])[1] > 0.5 > at(52, 60, areas=[turned])[1]
        for name, wrong in (
            ('form.kind is "square"', {"form": {**form, "kind": "square"}}),
            ("form.bevel is 0", {"form": {**form, "bevel": 0}}),
            ("form is 3", {"form": 3}),
            ("areas[0].form.bevel is missing", {"areas": [{**area, "form": {"kind": "flat"}}]}),
            ("areas[0].soft is 2", {"areas": [{**area, "soft": 2}]}),
        ):
            answer = client.post("/api/predict", json=asking(900, **wrong))
            assert (answer.status_code, answer.json()["error"].startswith(name)) == (400, True), answer.text
