"""Models made to harm, true to ONNX's grammar: refused before they are loaded, or when they have painted."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
import pytest
from onnx import GraphProto, ModelProto, NodeProto, TensorProto, ValueInfoProto, helper, numpy_helper

from normalgan.errors import InputError
from normalgan.inference.network import onnx_backend
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.network.onnx_graph import MOST_NODES, check_graph
from normalgan.weights.shipped import SHIPPED
from onnx_models import write_model

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


def body() -> GraphProto:
    """Return what a loop does each time: nothing, and it wants to go on."""
    taken = [value("i", kind=TensorProto.INT64), value("on", kind=TensorProto.BOOL), value("was", 1)]
    given = [value("more", kind=TensorProto.BOOL), value("is", 1)]
    steps = [node("Identity", "on", "more"), node("Identity", "was", "is")]
    return helper.make_graph(steps, "body", taken, given)


def loop() -> ModelProto:
    weights = [constant("times", 2**62, np.int64), constant("true", True, np.bool_), constant("start", [0])]
    again = node("Loop", "times true start", "end", body=body())
    return made([again, node("Add", "sketch end", "grown"), node("Concat", "grown " * 3, axis=1)], weights)


def branch() -> ModelProto:
    one = helper.make_graph(
        [node("Identity", "sketch", "out")], "one", [], [value("out", "N", 1, SIZE, SIZE)]
    )
    chosen = node("If", "true", "some", then_branch=one, else_branch=one)
    return made([chosen, node("Concat", "some some some", axis=1)], [constant("true", True, np.bool_)])


def functions() -> ModelProto:
    """Return functions of ten calls each of the one before: 10^9 nodes when they are written out."""
    opset = [helper.make_opsetid("", 17), helper.make_opsetid("own", 1)]
    inner = [helper.make_function("own", "f0", ["x"], ["y"], [node("Neg", "x", "y")], opset)]
    for i in range(1, 10):
        calls = [
            node(f"f{i - 1}", f"x{j}" if j else "x", f"x{j + 1}" if j < 9 else "y", domain="own")
            for j in range(10)
        ]
        inner.append(helper.make_function("own", f"f{i}", ["x"], ["y"], calls, opset))
    return made([VECTORS], functions=inner)


def elsewhere() -> ModelProto:
    weight = constant("one", np.ones((3, 1, 1)))
    weight.ClearField("raw_data")
    weight.data_location = TensorProto.EXTERNAL
    weight.external_data.add(key="location", value="../../secret")
    return made([node("Mul", "sketch one")], [weight])


def claimed() -> ModelProto:
    weight = constant("one", np.ones((3, 1, 1)))
    weight.dims[:] = [2**40, 3, 1]
    return made([node("Mul", "sketch one")], [weight])


def sparse() -> ModelProto:
    model = made([VECTORS])
    held = helper.make_sparse_tensor(constant("v", [1.0]), constant("i", [0], np.int64), [2**40])
    model.graph.sparse_initializer.add().CopyFrom(held)
    return model


def inside() -> ModelProto:
    """Return a model with numbers elsewhere that are no weight of the graph, but an operator's."""
    held = elsewhere().graph.initializer[0]
    return made([node("Constant", "", "one", value=held), node("Mul", "sketch one")])


def foreign() -> ModelProto:
    return made([node("Run", "sketch", domain="somebody"), VECTORS])


def many() -> ModelProto:
    steps = [node("Neg", f"x{i}" if i else "sketch", f"x{i + 1}") for i in range(MOST_NODES + 1)]
    return made([*steps, VECTORS])


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (loop, "holds the operator Loop, which runs other graphs"),
        (branch, "holds the operator If, which runs other graphs"),
        (functions, "holds functions of its own"),
        (elsewhere, "holds weights that lie in another file"),
        (inside, "holds weights that lie in another file"),
        (claimed, "holds weights of 1099511627776 × 3 × 1 numbers, which are not there"),
        (sparse, "holds sparse weights"),
        (foreign, "holds the operator Run of somebody"),
        (many, "holds more than 20000 operators"),
    ],
    ids=lambda each: each.__name__ if callable(each) else "",
)
def test_what_no_generator_needs_is_refused_before_it_is_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, make: Callable[[], ModelProto], sentence: str
) -> None:
    monkeypatch.setattr(onnxruntime, "InferenceSession", None)
    (tmp_path / "bad.onnx").write_bytes(make().SerializeToString())
    with pytest.raises(InputError, match="bad.onnx " + sentence) as refused:
        OnnxBackend(tmp_path / "bad.onnx")
    assert str(refused.value).endswith("; a generator is one plain graph, as `normalgan export` writes.")


@pytest.mark.parametrize(
    "content",
    [
        b"\xff" * 20,
        b"\x3a\xff\xff\xff\xff\x7f",  # a graph of gigabytes
        b"\x3a\x05\x0a\xff\xff\xff\x7f",
        b"\x3b" * 1000,  # groups in groups
        b"\x3a" + struct.pack("B", 100),
    ],
)
def test_what_is_no_protobuf_is_refused(content: bytes) -> None:
    with pytest.raises(InputError, match="it is not ONNX; `normalgan export` writes it"):
        check_graph("bad.onnx", content)


def test_sound_models_pass(tmp_path: Path) -> None:
    assert check_graph("ours.onnx", SHIPPED.read_bytes())  # whose weights are half as long: cast on loading
    assert check_graph("ramp.onnx", write_model(tmp_path / "ramp.onnx").read_bytes())


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
def test_what_does_not_paint_is_refused_in_one_sentence(
    tmp_path: Path, nodes: list[NodeProto], sentence: str
) -> None:
    weights = [constant("minus", -1), constant("zero", 0), constant("shape", [7, 7], np.int64)]
    wide = node("Concat", "sketch sketch sketch", "wide", axis=1)
    (tmp_path / "bad.onnx").write_bytes(made([wide, *nodes], weights).SerializeToString())
    with pytest.raises(InputError, match=f"^the model .*bad.onnx {sentence}") as refused:
        OnnxBackend(tmp_path / "bad.onnx").predict(np.zeros((SIZE, SIZE), np.float32))
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("of_what", ["weights", "the input"])
def test_a_small_number_that_asks_for_much_memory_gets_none(tmp_path: Path, of_what: str) -> None:
    shape = [constant("shape", [3 * 2**28], np.int64)]  # 3 GiB
    if of_what == "weights":  # which is computed on loading, unless that is forbidden
        large = node("ConstantOfShape", "shape", "large")
    else:
        large = node("Expand", "any shape", "large")
    steps = [
        node("ReduceSum", "sketch", "any", keepdims=0),
        large,
        node("ReduceSum", "large", "sum", keepdims=0),
    ]
    steps += [node("Add", "sketch sum", "one"), node("Concat", "one one one", axis=1)]
    content = made(steps, shape).SerializeToString()
    assert check_graph("large.onnx", content) is (of_what == "the input")
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
    with pytest.raises(InputError, match=r"name\.onnx is not a model that ONNX Runtime can run: .*\.$"):
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
