"""Quantises the reader and the refiner, which then compute with 8-bit integers and take half the time.

quantize.py DRAWING…

The networks in tools/networks predict the maps of the drawings, and the ranges of their activations are
recorded. Use drawings like those in training; `tools/reader/page_pictures.py` writes some. The quantised
networks replace those in src/normalgan/weights.
"""

import argparse
import tempfile
from itertools import cycle
from pathlib import Path
from typing import Any

import onnx
import onnxruntime
from onnxruntime.quantization import CalibrationDataReader, QuantFormat, QuantType, quantize_static
from onnxruntime.quantization.shape_inference import quant_pre_process

import normalgan
from normalgan.errors import InputError
from normalgan.inference.cleaning import reader
from normalgan.inference.network.upsampling import Refiner
from normalgan.weights.shipped import READER_FILE, REFINER

FLOAT = Path(__file__).parent / "networks"
TRUNKS = {
    READER_FILE: ("/enter.", "/down.1", "/down.2", "/down.3", "/leave.", "/up.1", "/up.2"),
    REFINER: ("node_conv2d_", "node_relu_", "node_add_"),
}
"""How names of the quantised nodes begin. Inputs, outputs and the reader's finest level, which places the
ink, stay as they are."""
SIDES = 512, 768, 1024
"""Sizes of the predicted maps; the refiner is used from 1.2 to 4 times the model's 256 pixels."""


class Recorder:
    """Runs a network and records its inputs."""

    def __init__(self, path: Path) -> None:
        self.session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        self.given: list[dict[str, Any]] = []

    def run(self, names: list[str], given: dict[str, Any]) -> Any:
        """Return the network's outputs."""
        self.given.append(given)
        return self.session.run(names, given)


class _Recorded(CalibrationDataReader):  # type: ignore[misc]  # the library has no types
    def __init__(self, given: list[dict[str, Any]]) -> None:
        self._given = iter(given)

    def get_next(self) -> dict[str, Any] | None:
        return next(self._given, None)


def main() -> None:
    """Record, quantise and write both networks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("drawings", type=Path, nargs="+")
    given = parser.parse_args()
    recorders = {target: Recorder(FLOAT / target.name) for target in TRUNKS}
    reader._session = lambda: recorders[READER_FILE]  # type: ignore[assignment]
    upsample = Refiner()
    upsample.__dict__["_session"] = recorders[REFINER]
    predictor = normalgan.load()
    predictor.upsample = upsample
    for drawing, side in zip(given.drawings, cycle(SIDES), strict=False):
        try:
            predictor(drawing, size=side)
        except InputError as error:  # a page may hold no drawing; the reader has seen it
            print(error)
    for target, recorder in recorders.items():
        quantize(FLOAT / target.name, target, recorder.given)


def quantize(source: Path, target: Path, given: list[dict[str, Any]]) -> None:
    """Write a network with the ranges of its activations on given inputs."""
    with tempfile.TemporaryDirectory() as folder:
        prepared = Path(folder) / "prepared.onnx"
        quant_pre_process(source, prepared, skip_symbolic_shape=True)
        graph = onnx.load(prepared).graph
        outputs = {output.name for output in graph.output}
        precise = [
            node.name
            for node in graph.node
            if not node.name.startswith(TRUNKS[target]) or outputs & set(node.output)
        ]
        quantize_static(
            prepared,
            target,
            _Recorded(given),
            quant_format=QuantFormat.QDQ,
            op_types_to_quantize=["Conv", "Add", "Relu", "Gemm"],
            nodes_to_exclude=precise,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            per_channel=True,
            reduce_range=True,  # 7 bits for weights, because some processors add pairs of products in 16 bits
        )


if __name__ == "__main__":
    main()
