"""Load a predictor from any file of a trained model, or the shipped model."""

from pathlib import Path

from normalgan.errors import InputError, without_extra
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.predictor import Predictor
from normalgan.weights.shipped import SHIPPED_NAME, find_model


def load(path_or_name: str | Path = SHIPPED_NAME, size: int | None = None) -> Predictor:
    """Return the predictor of a trained model.

    ONNX files, such as the shipped model, load quickly and do not need torch.

    Args:
        path_or_name: ``shipped``, or a file: ``.onnx`` or ``.safetensors`` that `normalgan export` wrote, or
            a checkpoint that `normalgan fit` saved; or the address of such a file with its hash,
            ``https://host/file#sha256=…`` or ``hf://owner/name[@revision][/file]#sha256=…``. It is fetched
            once.
        size: side in pixels of the pictures of a checkpoint's training; None if the file records it.

    Raises:
        InputError: if the file is not a usable model, or needs PyTorch, which is not installed.
    """
    backend = _backend(str(path_or_name), size)
    if size not in (None, backend.size):
        raise InputError(
            f"{path_or_name} predicts pictures of {backend.size} pixels, not {size}; omit size: "
            "drawings of any size are resized for it."
        )
    return Predictor(backend)


def _backend(name: str, size: int | None) -> Backend:
    path = find_model(name)
    if path.suffix.lower() == ".onnx":
        return OnnxBackend(path)
    try:  # imported here because torch takes seconds to import
        from normalgan.inference.network.torch_backend import TorchBackend
        from normalgan.weights.checkpoint import read_model
    except ModuleNotFoundError as error:
        if sentence := without_extra(f"{path}, which is not an ONNX file,", error):
            raise InputError(sentence) from error
        raise
    weights = read_model(path, size)
    notes = weights.notes
    return TorchBackend(weights.generator(), notes.size, refined=notes.refined, line_widths=notes.line_widths)
