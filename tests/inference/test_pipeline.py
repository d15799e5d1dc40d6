from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.mask.mask_files import MODEL, OUTLINE
from normalgan.inference.network.extension import extend
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import predict
from normalgan.inference.predictor import Predictor
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import Picture
from normalgan.normals import normalize
from onnx_models import ramp, write_model
from pens import blob, outline, overlap


def drawn(scale: int = 1, width: float = 3.0) -> tuple[Picture, Floats]:
    filled = blob((200 * scale, 300 * scale), (170 * scale, 90 * scale), 60 * scale)
    ink = outline(filled, width * scale)
    return Picture(np.repeat(1 - ink[..., None], 3, -1), None), filled


def degrees(one: Floats, other: Floats) -> Floats:
    cross = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.rad2deg(np.arctan2(cross, (one * other).sum(-1))), np.float32)


def expected(shape: tuple[int, int], filled: Floats) -> Floats:
    """Return the model's ramp as it lies on the square around a drawing, with 6 % of it left free."""
    rows, columns = np.nonzero(outline(filled, 3) > 0.1)
    top, bottom, left, right = rows.min(), rows.max() + 1, columns.min(), columns.max() + 1
    side = max(bottom - top, right - left) / 0.88
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    x = ((x - (left + right - side) / 2) / side) * 1.2 - 0.6
    y = -(((y - (top + bottom - side) / 2) / side) * 1.2 - 0.6)
    return np.stack([x, y, np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))], -1).astype(np.float32)


def assert_in_place(predicted: NormalMap, filled: Floats) -> None:
    assert predicted.extended.shape == (*filled.shape, 3)
    assert np.abs(np.linalg.norm(predicted.extended, axis=-1) - 1).max() < 1e-5
    assert overlap(predicted.mask, np.maximum(filled, outline(filled))) > 0.94
    # A pixel of the drawing is some 0.4 degrees on the ramp.
    assert degrees(predicted.extended, expected(filled.shape, filled))[filled > 0.5].mean() < 1.5


@pytest.mark.parametrize("scale", [1, 3])
def test_what_is_painted_lies_where_it_was_drawn(model: Path, scale: int) -> None:
    picture, filled = drawn(scale)
    predicted = predict(OnnxBackend(model), prepare(picture, 64))
    assert_in_place(predicted, filled)
    assert predicted.warning == ""
    assert predicted.seen.shape == (64, 64)


def test_the_map_may_be_larger_or_smaller_than_the_drawing(model: Path) -> None:
    picture, _ = drawn(2)
    for longest, scale in ((300, 1), (900, 3)):
        predicted = predict(OnnxBackend(model), prepare(picture, 64, longest=longest))
        assert_in_place(predicted, drawn(scale)[1])


def test_a_drawing_too_large_to_work_on_keeps_its_size(model: Path) -> None:
    picture, filled = drawn(8)
    predicted = predict(OnnxBackend(model), prepare(picture, 64))
    assert predicted.mask.shape == filled.shape == (1600, 2400)
    assert overlap(predicted.mask, filled) > 0.94


@pytest.mark.parametrize("width", [1.0, 3.0, 9.0])
def test_the_model_sees_lines_of_the_width_it_knows(width: float) -> None:
    picture, _ = drawn(2, width)
    seen = prepare(picture, 128).model_input
    length = 0.88 * 128 * 3.2  # of an outline as wide as high
    assert seen.sum() / length == pytest.approx(1.25, rel=0.35)
    assert seen.max() > 0.9


def test_lines_that_the_model_knows_are_shown_as_they_were_drawn() -> None:
    picture, _ = drawn(2, 5.0)
    prepared = prepare(picture, 128, line_widths=(0.5, 5.0))
    assert (prepared.model_input == prepared.frame.cut(prepared.ink)).all()
    assert prepared.model_input.sum() > 1.5 * prepare(picture, 128).model_input.sum()


@pytest.mark.parametrize("width", [0.7, 1.2, 2.0, 3.0, 4.5, 6.0, 9.0, 12.0, 14.0, 40.0])
def test_what_is_told_by_fewer_pixels_is_what_all_of_them_tell(
    width: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    picture, _ = drawn(2, width / 2)
    quick = prepare(picture, 128, line_widths=(0.5, 5.0)).model_input
    monkeypatch.setattr("normalgan.inference.network.line_width._is_known", lambda *_: False)
    assert (prepare(picture, 128, line_widths=(0.5, 5.0)).model_input == quick).all()


def test_beside_lines_that_the_model_knows_only_areas_are_drawn_anew() -> None:
    picture, _ = drawn(2, 5.0)
    colour = picture.colour.copy()
    colour[160:220, 260:340] = 0
    seen, without = (
        prepare(Picture(each, None), 128, line_widths=(0.5, 5.0)) for each in (colour, picture.colour)
    )
    changed = np.abs(seen.model_input - without.model_input) > 0.3
    rows, columns = np.nonzero(changed)
    frame = seen.frame
    assert frame == without.frame
    scale = frame.side / frame.size
    assert frame.top + scale * rows.min() > 150
    assert frame.top + scale * rows.max() < 230
    assert frame.left + scale * columns.min() > 250
    assert frame.left + scale * columns.max() < 350
    assert not seen.model_input[int((190 - frame.top) / scale), int((300 - frame.left) / scale)]


def test_hints_reach_the_pixel_they_are_for(model: Path) -> None:
    picture, _ = drawn()
    hint = normalize(np.array([[-0.8, 0.1, 0.6]]))
    for longest in (None, 900):
        prepared = prepare(
            picture, 64, hints=Hints(np.array([[200.5, 110.5]], np.float32), hint), longest=longest
        )
        assert prepared.hints is not None
        assert prepared.hints[3].sum() == 1
        predicted = predict(OnnxBackend(model), prepared)
        scale = predicted.mask.shape[1] / 300
        rows, columns = np.nonzero(
            degrees(predicted.extended, np.broadcast_to(hint[0], predicted.extended.shape)) < 15
        )
        assert len(rows)
        assert abs(rows.mean() / scale - 110.5) < 2
        assert abs(columns.mean() / scale - 200.5) < 2


def test_a_mask_given_wins_and_is_filled_whatever_the_model_thinks(tmp_path: Path) -> None:
    import onnx
    from onnx import numpy_helper

    path = write_model(tmp_path / "holed.onnx")
    holed = ramp(64)
    holed[:, 20:44, 20:44] *= 0.01
    graph = onnx.load(path)
    graph.graph.initializer[1].CopyFrom(numpy_helper.from_array(holed[None], "ramp"))
    onnx.save(graph, path)
    picture, filled = drawn()
    predicted = predict(OnnxBackend(path), prepare(picture, 64, mask=filled > 0.5))
    assert (predicted.mask == (filled > 0.5)).all()
    # The ramp is nearly harmonic, so that the hole does not show.
    assert degrees(predicted.extended, expected(filled.shape, filled))[filled > 0.5].max() < 6


@pytest.mark.parametrize("scale", [1, 2])
def test_a_hole_that_was_filled_meets_the_object_at_its_line(model: Path, scale: int) -> None:
    filled = blob((200, 300), (170, 90), 60)
    inner, other = blob((200, 300), (150, 90), 20), blob((200, 300), (205, 90), 12)
    ink = np.max([outline(each, 3) for each in (filled, inner, other)], 0)
    clear, around = ink < 0.35, np.maximum(filled, ink) > 0.5  # a click fills up to where the line begins
    holes = ((inner > 0.5) | (other > 0.5)) & (ink <= 0.5)
    painted = (clear & (inner > 0.5)).astype(np.int8)
    picture = Picture(np.repeat(1 - ink[..., None], 3, -1), None)
    prepared = prepare(picture, 64, mask=around & ~holes, longest=300 * scale, painted=painted)
    predicted = predict(OnnxBackend(model), prepared)
    within = cv2.resize((inner > 0.5).astype(np.uint8), None, fx=scale, fy=scale) > 0
    assert predicted.mask[within].all()
    assert predicted.alpha[within].min() == 1
    assert not predicted.mask[90 * scale, 205 * scale]  # another hole stays one


def test_the_models_own_mask_is_what_is_long_enough(tmp_path: Path) -> None:
    picture, _ = drawn()
    whole = predict(OnnxBackend(write_model(tmp_path / "all.onnx")), prepare(picture, 64, mask=MODEL))
    frame = prepare(picture, 64).frame
    assert whole.mask.sum() == pytest.approx(
        frame.side * 200, rel=0.2
    )  # the square, cut at the picture's edge
    with pytest.raises(InputError, match="the model sees no object in it"):
        predict(OnnxBackend(write_model(tmp_path / "none.onnx", length=0.01)), prepare(picture, 64))
    with pytest.raises(InputError, match="the model sees no object in it"):
        predict(OnnxBackend(write_model(tmp_path / "few.onnx", length=0.3)), prepare(picture, 64, mask=MODEL))


def test_lines_that_enclose_nothing_are_told(model: Path) -> None:
    line = np.zeros((200, 300), np.float32)
    line[100, 40:260] = 1
    picture = Picture(np.repeat(1 - line[..., None], 3, -1), None)
    predicted = predict(OnnxBackend(model), prepare(picture, 64, mask=OUTLINE))
    assert "no object was found among its lines" in predicted.warning


def test_a_model_that_sees_little_is_told(tmp_path: Path) -> None:
    import onnx
    from onnx import numpy_helper

    path = write_model(tmp_path / "half.onnx")
    graph = onnx.load(path)
    half = ramp(64)
    half[:, :, 20:] = 0
    graph.graph.initializer[1].CopyFrom(numpy_helper.from_array(half[None], "ramp"))
    onnx.save(graph, path)
    predicted = predict(OnnxBackend(path), prepare(drawn()[0], 64))
    assert "for an object and is unsure of the rest" in predicted.warning


def test_the_drawings_own_opacity_is_kept(model: Path) -> None:
    filled = blob()
    soft = np.clip(filled * 0.5 + 0.5 * np.roll(filled, 1, 0), 0, 1)
    grey = np.full((*filled.shape, 3), 0.4, np.float32)
    predicted = predict(OnnxBackend(model), prepare(Picture(grey, soft), 64))
    assert np.abs(predicted.alpha - soft).max() < 1e-6


def test_confidence_comes_to_the_drawings_place(tmp_path: Path) -> None:
    picture, filled = drawn()
    predicted = predict(OnnxBackend(write_model(tmp_path / "sure.onnx")), prepare(picture, 64))
    assert predicted.confidence is not None
    on_lines = predicted.confidence[outline(filled) > 0.9].mean()
    assert on_lines > 1.4
    assert predicted.confidence[80:100, 160:180].mean() < 1.2
    without = OnnxBackend(write_model(tmp_path / "unsure.onnx", confidence=False))
    assert predict(without, prepare(picture, 64)).confidence is None


def test_an_extension_is_harmonic() -> None:
    # Of boundary values cos(2 angle), the harmonic extension into the disc is x² - y².
    y, x = np.mgrid[-1:1:65j, -1:1:65j]
    truth = np.stack([0.3 * (x**2 - y**2), 0.3 * x * y, np.ones_like(x)], -1).astype(np.float32)
    known = np.hypot(x, y) > 0.5
    filled = extend(normalize(truth), known, ~known)
    assert (filled[known] == normalize(truth)[known]).all()
    assert degrees(filled, normalize(truth)).max() < 1.5


def test_the_same_picture_gives_the_same_map(model: Path) -> None:
    picture, _ = drawn()
    session = OnnxBackend(model)
    first, second = (predict(session, prepare(picture, 64)) for _ in range(2))
    assert (first.extended == second.extended).all()


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"no model", "is not a model that ONNX Runtime can run"), (b"", "is not a model that ONNX")],
)
def test_what_is_no_model_is_told(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "bad.onnx").write_bytes(content)
    with pytest.raises(InputError, match=message):
        OnnxBackend(tmp_path / "bad.onnx")


def test_a_model_of_others_is_told(tmp_path: Path) -> None:
    from onnx import TensorProto, helper, save

    value = helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, 8, 8])
    out = helper.make_tensor_value_info("out", TensorProto.FLOAT, [1, 3, 8, 8])
    graph = helper.make_graph([helper.make_node("Identity", ["image"], ["out"])], "other", [value], [out])
    opset = [helper.make_opsetid("", 17)]
    save(helper.make_model(graph, opset_imports=opset, ir_version=8), tmp_path / "other.onnx")
    with pytest.raises(InputError, match="takes image and gives out, which is not what"):
        OnnxBackend(tmp_path / "other.onnx")


def test_doubt_of_the_object_is_no_doubt_of_the_direction(tmp_path: Path) -> None:
    picture, filled = drawn()
    predicted = predict(OnnxBackend(write_model(tmp_path / "shy.onnx", length=0.3)), prepare(picture, 64))
    assert degrees(predicted.extended, expected(filled.shape, filled))[filled > 0.5].mean() < 1.5
    assert "takes only 0% of its mask for an object" in predicted.warning


def test_the_same_picture_gives_the_same_map_wherever_it_lies_in_memory(model: Path) -> None:
    # Some functions of OpenCV treat what lies beside a multiple of 64 bytes in another way.
    session, picture = OnnxBackend(model), drawn()[0]
    first = predict(session, prepare(picture, 64)).extended
    ballast = []
    for i in range(12):
        ballast.append(np.empty(16 + 1016 * i + 4 * i, np.uint8))
        assert (predict(session, prepare(picture, 64)).extended == first).all()


def test_hints_off_the_object_are_told_with_their_places(model: Path) -> None:
    picture, filled = drawn(1)
    rows, columns = np.nonzero(filled)
    y, x = int(np.median(rows)), int(np.median(columns))
    on = {"x": x, "y": y, "normal": [0, 0, 1]}
    off = [{**on, "x": each, "y": 3} for each in (2, 5, 11, 17)]

    def said(*hints: dict[str, Any], size: int | None = None) -> str:
        return Predictor(OnnxBackend(model))(picture, list(hints), size=size).warning

    assert said(on) == ""
    edge = {**on, "x": int(columns[rows == y].min()) - 2, "y": y}  # of the line: the mask there is a guess
    assert said(on, edge) == ""
    one = (
        "1 of 2 hints lies off the object, at x 2, y 3; move it onto it, or give --mask if the mask is wrong"
    )
    assert said(on, off[0]) == one
    assert said(on, off[0], size=900) == one  # places are those of the drawing
    assert "4 of 5 hints lie off the object, at x 2, y 3; x 5, y 3; x 11, y 3 and 1 more; mo" in said(
        on, *off
    )


def crossed_once(picture: Picture) -> float:
    """Return the fraction of directions from the input's middle that cross one line."""
    ink = prepare(picture, 256).model_input > 0.5
    crossed = []
    for turn in np.linspace(0, 2 * np.pi, 32, endpoint=False):
        along = 128 + np.arange(0, 126, 0.5)[:, None] * [np.cos(turn), np.sin(turn)]
        column, row = along.astype(int).T
        crossed.append(np.count_nonzero(np.diff(ink[row, column].astype(int)) == 1))
    return float(np.mean(np.equal(crossed, 1)))


@pytest.mark.parametrize("side", [32, 48])
def test_the_outline_of_a_tiny_icon_is_one_line(side: int) -> None:
    big = np.zeros((8 * side, 8 * side, 4), np.float32)
    cv2.circle(big, (4 * side, 4 * side), round(3.2 * side), (0.1, 0.1, 0.1, 1), -1)
    cv2.circle(big, (4 * side, 4 * side), round(2.9 * side), (0.8, 0.2, 0.2, 1), -1)
    small = big.reshape(side, 8, side, 8, 4).mean((1, 3))
    colour = small[..., :3] / np.maximum(small[..., 3:], 1e-4)
    assert crossed_once(Picture(colour, small[..., 3])) > 0.9


@pytest.mark.parametrize("around", [1, 16])
def test_a_sprite_of_few_art_pixels_has_one_outline(around: int) -> None:
    side = 14 + 2 * around
    apart = np.hypot(*(np.mgrid[:side, :side] + 0.5 - side / 2))
    there = apart < 7
    inner = cv2.erode(there.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0) > 0
    colour = np.where(inner[..., None], [0.3, 0.7, 0.3], 0.1).astype(np.float32)
    assert crossed_once(Picture(colour, there.astype(np.float32))) > 0.9
