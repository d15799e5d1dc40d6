"""Fuzz target: models as ONNX, which are looked through, loaded, and paint nothing."""

import harness
import numpy as np

with harness.instrumented():
    from normalgan.inference.network.onnx_backend import OnnxBackend


def read(data: bytes) -> None:
    """Paint with a model."""
    with harness.refusals():
        model = OnnxBackend(harness.as_file(data, "model.onnx"), threads=1)
        normals, _ = model.predict(np.zeros((model.size, model.size), np.float32))
        assert normals.shape == (model.size, model.size, 3)
        assert np.isfinite(normals).all()


if __name__ == "__main__":
    harness.run(read)
