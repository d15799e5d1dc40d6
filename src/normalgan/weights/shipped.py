"""The files of weights that come with the package, and any other model by its name; no torch."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from normalgan.errors import InputError, did_you_mean
from normalgan.files.addresses import local_file

__all__ = ["READER", "REFINER", "SHIPPED", "SHIPPED_NAME", "find_model"]

_HERE = Path(__file__).parent
SHIPPED = _HERE / "ours.onnx"
"""The model: ONNX Runtime runs it, and torch reads its weights."""
SHIPPED_NAME = "shipped"
"""What it is called where a file is asked for."""
REFINER = _HERE / "refiner.onnx"
"""Brings the model's maps to a drawing's own size."""
READER = _HERE / "reader.onnx"
"""Tells lines from the page, and the object from air."""
_FORMATS = (".onnx", ".safetensors", ".ckpt")


def find_model(
    name: str | None = None, formats: Sequence[str] = _FORMATS, names: Iterable[str] = (SHIPPED_NAME,)
) -> Path:
    """Return the file of a model: the one named, or the one that comes with the package.

    Args:
        name: the path or the address; None, or ``shipped``, for the package's own.
        formats: what the file may end in, for messages.
        names: the names that can be given in place of a file, for messages.

    Raises:
        InputError: if there is none, or an address cannot be fetched (see `local_file`).
    """
    if name is None or name == SHIPPED_NAME:
        if not SHIPPED.is_file():
            raise InputError(
                "no model comes with this package; name one that `normalgan export` wrote with --model."
            )
        return SHIPPED
    path = local_file(name)
    # Who reads checkpoints says which file of a run's folder to name.
    if not path.is_file() and not (path.is_dir() and ".ckpt" in formats):
        known = list(names)
        raise InputError(
            f"there is no model {name}; give a file ({', '.join(formats)}), an address (https://…, "
            f"hf://owner/name), or {', '.join(known)}.{did_you_mean(name, known)}"
        )
    return path
