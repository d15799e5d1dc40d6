"""Model files: those that come with the package, and any other by path or address; does not need torch."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from normalgan.errors import InputError, did_you_mean
from normalgan.files.addresses import local_file

_HERE = Path(__file__).parent
SHIPPED = _HERE / "ours.onnx"
"""The generator, run by ONNX Runtime; torch can read its weights."""
SHIPPED_NAME = "shipped"
"""Name of the shipped generator where a file is expected."""
REFINER = _HERE / "refiner.onnx"
"""The refiner, which upsamples the generator's maps to a drawing's own size."""
READER_FILE = _HERE / "reader.onnx"
"""The network that segments lines and object."""
_FORMATS = (".onnx", ".safetensors", ".ckpt")


def find_model(
    name: str | None = None, formats: Sequence[str] = _FORMATS, names: Iterable[str] = (SHIPPED_NAME,)
) -> Path:
    """Return the file of the given model, or of the shipped one.

    Args:
        name: path or address; None or ``shipped`` for the shipped model.
        formats: accepted file extensions, for messages.
        names: names accepted instead of a file, for messages.

    Raises:
        InputError: if there is no such model, or an address cannot be downloaded (see `local_file`).
    """
    if name is None or name == SHIPPED_NAME:
        if not SHIPPED.is_file():
            raise InputError(
                "no model comes with this package; name one that `normalgan export` wrote with --model."
            )
        return SHIPPED
    path = local_file(name)
    # The reader of checkpoints explains which file of a run's folder to give.
    if not path.is_file() and not (path.is_dir() and ".ckpt" in formats):
        known = list(names)
        raise InputError(
            f"there is no model {name}; give a file ({', '.join(formats)}), an address (https://…, "
            f"hf://owner/name), or {', '.join(known)}.{did_you_mean(name, known)}"
        )
    return path
