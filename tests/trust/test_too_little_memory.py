"""A machine without memory is said to be one; no file is called bad for it."""

from pathlib import Path

import onnx
import onnxruntime
import pytest
import torch

from normalgan.errors import RunError
from normalgan.files.torch_files import load_torch_file
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.weights.file import read_weights
from normalgan.weights.shipped import SHIPPED, find_model


@pytest.mark.parametrize("error", [MemoryError(), RuntimeError("Exception during loading: std::bad_alloc")])
def test_too_little_memory_is_not_a_bad_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    torch.save({}, tmp_path / "a.ckpt")
    with monkeypatch.context() as patched:
        patched.setattr(onnxruntime, "InferenceSession", fail)
        with pytest.raises(RunError, match="too little memory to load the model"):
            OnnxBackend(find_model())
    with monkeypatch.context() as patched:
        patched.setattr(torch, "load", fail)
        with pytest.raises(RunError, match=r"too little memory to read .*a\.ckpt"):
            load_torch_file(tmp_path / "a.ckpt")
    monkeypatch.setattr(onnx, "load_from_string", fail)
    with pytest.raises(RunError, match=r"too little memory to read .*ours\.onnx"):
        read_weights(SHIPPED)
