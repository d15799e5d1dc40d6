"""Models as ONNX that paint a known function of what they are given."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper, save


def ramp(size: int) -> NDArray[np.float32]:
    """Return unit normals (3, size, size): x grows to the right, y upwards, both from -0.6 to 0.6."""
    at = (np.arange(size) + 0.5) / size * 1.2 - 0.6
    x, y = np.meshgrid(at, -at)
    return np.stack([x, y, np.sqrt(1 - x**2 - y**2)]).astype(np.float32)


def write_model(
    path: Path, size: int = 64, length: float = 1.0, confidence: bool = True, reach: int = 0
) -> Path:
    """Write a model that paints the ramp times ``length`` and, as far around hints as they reach, these."""

    def constant(name: str, value: NDArray[np.generic]) -> TensorProto:
        return numpy_helper.from_array(np.asarray(value), name)

    nodes = [
        helper.make_node("Conv", ["hints", "kernel"], ["spread"], group=4, pads=[reach] * 4),
        helper.make_node("Split", ["spread", "parts"], ["vectors", "where"], axis=1),
        helper.make_node("Sub", ["one", "where"], ["free"]),
        helper.make_node("Mul", ["ramp", "free"], ["painted"]),
        helper.make_node("Add", ["painted", "vectors"], ["normal"]),
    ]
    outputs = [helper.make_tensor_value_info("normal", TensorProto.FLOAT, ["N", 3, size, size])]
    if confidence:
        nodes.append(helper.make_node("Add", ["sketch", "one"], ["confidence"]))
        outputs.append(helper.make_tensor_value_info("confidence", TensorProto.FLOAT, ["N", 1, size, size]))
    graph = helper.make_graph(
        nodes,
        "ramp",
        [
            helper.make_tensor_value_info("sketch", TensorProto.FLOAT, ["N", 1, size, size]),
            helper.make_tensor_value_info("hints", TensorProto.FLOAT, ["N", 4, size, size]),
        ],
        outputs,
        [
            constant("one", np.ones((1, 1, 1, 1), np.float32)),
            constant("ramp", length * ramp(size)[None]),
            constant("kernel", np.ones((4, 1, 2 * reach + 1, 2 * reach + 1), np.float32)),
            constant("parts", np.array([3, 1])),
        ],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    save(model, path)
    return path
