"""Writes the mean of the weights of exported readers: mean.py OUT.onnx READER.onnx READER.onnx."""

import argparse
from pathlib import Path

import numpy as np
import onnx
from onnx import numpy_helper


def main() -> None:
    """Write the mean."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("readers", type=Path, nargs="+")
    given = parser.parse_args()
    first, *others = (onnx.load(path) for path in given.readers)
    stored = [{each.name: numpy_helper.to_array(each) for each in own.graph.initializer} for own in others]
    for weights in first.graph.initializer:
        own = numpy_helper.to_array(weights)
        if own.dtype == np.float32:
            mean = np.mean([own, *(each[weights.name] for each in stored)], axis=0, dtype=np.float64)
            weights.CopyFrom(numpy_helper.from_array(np.asarray(mean, np.float32), weights.name))
    onnx.save(first, given.out)


if __name__ == "__main__":
    main()
