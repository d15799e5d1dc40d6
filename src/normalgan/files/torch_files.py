"""Safe loading of files by `torch.save`: data only, and no more than the file's length."""

import io
import pickletools
import re
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from normalgan.errors import InputError, RunError, wants_memory
from normalgan.files.limits import refuse_pointer

__all__ = ["MOST_OBJECTS", "MOST_PARTS", "load_torch_file"]

MOST_OBJECTS = 2**24
"""Larger pickles are refused, in bytes: the names and shapes of ten thousand tensors have a tenth of it."""
MOST_PARTS = 100_000
"""More parts of an archive, or values in it, than any checkpoint has."""

# Those that `normalgan fit` and Lightning's callbacks put in. torch allows more under weights_only, such as
# bytearray, with which one number asks for all memory.
_DATA = {
    ("collections", "OrderedDict"),
    ("torch", "Size"),
    ("torch._utils", "_rebuild_parameter"),
    ("torch._utils", "_rebuild_tensor_v2"),
    ("__builtin__", "set"),
    ("_codecs", "encode"),
}
_NUMBERS = re.compile(
    r"(Float|Double|Half|BFloat16|Long|Int|Short|Char|Byte|Bool)Storage|u?int\d+|b?float\d+|bool"
)
_END = struct.Struct("<4s4H2LH")  # the end of a zip file
_PLACE64 = struct.Struct("<4sLQL")  # where that of a long one is
_END64 = struct.Struct("<4sQ2H2L4Q")


def load_torch_file(path: Path) -> Any:
    """Load a file of `torch.save`; tensors are memory-mapped.

    Nothing in it is executed, and nothing is imported or allocated before it is checked.

    Raises:
        InputError: if it is missing, damaged, or holds anything but data.
    """
    if path.is_dir():
        raise InputError(
            f"{path} is a folder; name a checkpoint in it, such as checkpoints/last.ckpt of a run."
        )
    if not path.is_file():
        raise InputError(f"there is no checkpoint {path}.")
    try:
        _check_pickle(_read_pickle(path))
        content = torch.load(path, map_location="cpu", weights_only=True, mmap=True)
        _check_tensors(content, path.stat().st_size)
    except PermissionError:
        raise InputError(f"the checkpoint {path} may not be read; change its permissions.") from None
    except InputError:
        raise
    except _RefusedError as error:
        raise InputError(
            f"{path} is damaged or no checkpoint: {error}; give one that `normalgan fit` saved."
        ) from None
    except Exception as error:  # whatever torch raises on other bytes; what it says is advice for programmers
        if wants_memory(error):
            raise RunError(f"there is too little memory to read {path}; close other programs.") from error
        raise InputError(
            f"{path} is damaged or no checkpoint; give one that `normalgan fit` saved."
        ) from None
    return content


class _RefusedError(Exception):
    """The reason why a file is not loaded, as part of a sentence."""


def _read_pickle(path: Path) -> bytes:
    """Return the objects of an archive, after checking that it holds no more bytes than the file has."""
    with path.open("rb") as file:
        refuse_pointer(path, file.read(64))
        directory = _directory(file)
        with zipfile.ZipFile(file) as archive:
            # zipfile makes up for bytes before the archive, torch does not: they would read two files.
            if archive.start_dir != directory:
                raise _RefusedError("it is not an archive of torch")
            parts = archive.infolist()
            if any(part.compress_type != zipfile.ZIP_STORED for part in parts):
                raise _RefusedError("its parts are compressed, which torch never does")
            if len(parts) > MOST_PARTS or sum(part.file_size for part in parts) > path.stat().st_size:
                raise _RefusedError("its parts are longer than the file")
            names = [part.filename.lower() for part in parts]  # torch finds a part by its name in any case
            if len(set(names)) < len(names):
                raise _RefusedError("two of its parts have the same name")
            found = [part for part in parts if re.fullmatch(r"[^/]+/data\.pkl", part.filename)]
            if len(found) != 1 or found[0].file_size > MOST_OBJECTS:
                raise _RefusedError("it is not an archive of torch")
            return archive.read(found[0])


def _directory(file: io.BufferedIOBase | Any) -> int:
    """Return where the list of an archive's parts begins; its end is the very end of the file."""
    length = file.seek(0, io.SEEK_END)
    file.seek(max(0, length - _END.size))
    end = file.read(_END.size)
    if len(end) < _END.size or not end.startswith(b"PK\x05\x06"):
        raise _RefusedError("it is not an archive of torch")
    *_, offset, comment = _END.unpack(end)
    if comment:
        raise _RefusedError("it is not an archive of torch")
    if offset == 2**32 - 1:
        file.seek(length - _END.size - _PLACE64.size)
        _, _, place, _ = _PLACE64.unpack(file.read(_PLACE64.size))
        file.seek(place)
        *_, offset = _END64.unpack(file.read(_END64.size))
    return int(offset)


def _check_pickle(content: bytes) -> None:
    """Check that a pickle names only the classes of plain data.

    Raises:
        _RefusedError: with the name, if it names anything else.
    """
    for operation, argument, _ in pickletools.genops(content):
        if operation.name == "GLOBAL":
            module, _, name = str(argument).partition(" ")
            if (module, name) not in _DATA and not (module == "torch" and _NUMBERS.fullmatch(name)):
                shown = re.sub(r"[^\w.]", "?", f"{module}.{name}")[:60]
                raise _RefusedError(f"it holds {shown}, and only numbers, texts and tensors are read")
        elif operation.name in {"STACK_GLOBAL", "INST", "EXT1", "EXT2", "EXT4", "PERSID"}:
            raise _RefusedError("it is a pickle that torch does not write")


def _check_tensors(content: Any, most: int) -> None:
    """Check that tensors are not larger than the file, because a view can repeat one number."""
    taken = 0
    for tensor in _tensors(content):
        taken += tensor.numel() * tensor.element_size()
        if taken > 2 * most:  # twice: weights may be tied
            raise _RefusedError("its tensors are larger than the file")


def _tensors(content: Any) -> Iterator[Tensor]:
    # A value may lie in many places, so that writing it out would take forever: each is looked at once.
    seen, waiting = set(), [content]
    while waiting:
        value = waiting.pop()
        if isinstance(value, Tensor):
            yield value
        elif isinstance(value, dict | list | tuple | set) and id(value) not in seen:
            seen.add(id(value))
            waiting += [*value, *value.values()] if isinstance(value, dict) else [*value]
