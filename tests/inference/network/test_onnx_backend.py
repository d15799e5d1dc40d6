"""Models as ONNX that are no generator: refused when they are loaded, or when they have predicted."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from onnx import ModelProto, NodeProto, TensorProto, ValueInfoProto, helper, numpy_helper

from normalgan.errors import InputError
from normalgan.inference.network import onnx_backend
from normalgan.inference.network.onnx_backend import OnnxBackend

SIZE = 16


def value(name: str, *shape: int | str, kind: int = TensorProto.FLOAT) -> ValueInfoProto:
    return helper.make_tensor_value_info(name, kind, shape)


def made(
    nodes: list[NodeProto], weights: list[TensorProto] | None = None, size: int = SIZE, **more: object
) -> ModelProto:
    """Return a model that takes what a generator takes."""
    graph = helper.make_graph(
        nodes,
        "graph",
        [value("sketch", "N", 1, size, size), value("hints", "N", 4, size, size)],
        [value("normal", "a", "b", "c", "d")],
        weights or [],
    )
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8, **more)


def constant(name: str, numbers: object, kind: type = np.float32) -> TensorProto:
    return numpy_helper.from_array(np.asarray(numbers, kind), name)


def node(operator: str, inputs: str, outputs: str = "normal", **attributes: Any) -> NodeProto:
    return helper.make_node(operator, inputs.split(), outputs.split(), **attributes)


VECTORS = node("Concat", "sketch sketch sketch", axis=1)


@pytest.mark.parametrize(
    ("nodes", "sentence"),
    [
        ([node("Log", "minus", "bad"), node("Add", "wide bad")], "gives normal that is not finite"),
        ([node("Div", "wide zero")], "gives normal that is not finite"),
        ([node("Identity", "sketch")], r"gives normal of the shape \(1, 1, 16, 16\), not \(1, 3, 16, 16\)"),
        ([node("ReduceSum", "wide", keepdims=0)], r"gives normal of the shape \(\), not"),
        ([node("Reshape", "wide shape")], "cannot be run: "),
    ],
    ids=["NaN", "division", "channels", "a number", "a failure"],
)
def test_what_does_not_predict_is_refused_in_one_sentence(
    tmp_path: Path, nodes: list[NodeProto], sentence: str
) -> None:
    weights = [constant("minus", -1), constant("zero", 0), constant("shape", [7, 7], np.int64)]
    wide = node("Concat", "sketch sketch sketch", "wide", axis=1)
    (tmp_path / "bad.onnx").write_bytes(made([wide, *nodes], weights).SerializeToString())
    with pytest.raises(InputError, match=f"^the model .*bad.onnx {sentence}") as refused:
        OnnxBackend(tmp_path / "bad.onnx").predict(np.zeros((SIZE, SIZE), np.float32))
    assert len(str(refused.value).splitlines()) == 1


def test_a_small_number_that_asks_for_much_memory_gets_none(tmp_path: Path) -> None:
    steps = [
        node("ReduceSum", "sketch", "any", keepdims=0),
        node("Expand", "any shape", "large"),
        node("ReduceSum", "large", "sum", keepdims=0),
        node("Add", "sketch sum", "one"),
        node("Concat", "one one one", axis=1),
    ]
    content = made(steps, [constant("shape", [3 * 2**28], np.int64)]).SerializeToString()  # 3 GiB
    (tmp_path / "large.onnx").write_bytes(content)
    with pytest.raises(InputError, match=r"large\.onnx takes more than 2 GiB of memory to predict"):
        OnnxBackend(tmp_path / "large.onnx").predict(np.zeros((SIZE, SIZE), np.float32))


def test_a_model_of_no_possible_size_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.onnx").write_bytes(made([VECTORS], size=100_000).SerializeToString())
    with pytest.raises(InputError, match="predicts pictures of 100000 × 100000 pixels; 8 to 2048 a side"):
        OnnxBackend(tmp_path / "bad.onnx")


def test_a_model_that_takes_too_long_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    side = 1500
    steps = [node("Resize", "sketch  sizes", "large", mode="nearest")]
    steps[0].input[:] = ["sketch", "", "", "sizes"]
    steps += [node("MatMul", f"large {f'm{i - 1}' if i else 'large'}", f"m{i}") for i in range(400)]
    weights = [constant("sizes", [1, 1, side, side], np.int64)]
    steps.append(node("Concat", "m399 m399 m399", axis=1))
    (tmp_path / "slow.onnx").write_bytes(made(steps, weights).SerializeToString())
    model = OnnxBackend(tmp_path / "slow.onnx")
    monkeypatch.setattr(onnx_backend, "PATIENCE", 0.5)
    with pytest.raises(InputError, match=r"slow\.onnx takes more than 0 seconds to predict"):
        model.predict(np.zeros((SIZE, SIZE), np.float32))


def plain() -> ModelProto:
    return made([VECTORS])


def noted() -> ModelProto:
    model = plain()
    helper.set_model_props(model, {"size": "missing"})
    return model


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: made([node("Neg", "missing", "x"), VECTORS]), b"missing"),
        (plain, b"hints"),
        (plain, b"normal"),
        (noted, b"missing"),
    ],
    ids=["operator", "input", "output", "note"],
)
def test_a_name_that_is_no_text_is_refused_and_nothing_is_printed(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], make: Callable[[], ModelProto], name: bytes
) -> None:
    path = tmp_path / "name.onnx"
    path.write_bytes(make().SerializeToString().replace(name, b"\x94" + name[1:]))
    with pytest.raises(InputError, match=r"name\.onnx is no model that ONNX Runtime can run: .*\.$"):
        OnnxBackend(path)
    assert capfd.readouterr() == ("", "")


def test_inputs_of_no_shape_or_with_odd_names_are_refused(tmp_path: Path) -> None:
    scalar = plain()
    scalar.graph.input[0].type.tensor_type.shape.ClearField("dim")
    scalar.graph.node[0].CopyFrom(node("Identity", "hints"))
    odd = plain()
    odd.graph.input.append(value("a\n" * 500, 1))
    for model, words in (
        (scalar, "takes sketch, hints and gives normal"),
        (odd, r"takes sketch, hints, a\?a"),
    ):
        path = tmp_path / "model.onnx"
        path.write_bytes(model.SerializeToString())
        with pytest.raises(InputError, match=words) as refusal:
            OnnxBackend(path)
        assert len(str(refusal.value)) < 600
        assert "\n" not in str(refusal.value)
