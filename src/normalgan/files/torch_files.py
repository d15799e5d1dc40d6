"""Safe loading of `torch.save` files: only plain data, and no more memory than the file's size."""

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

_MOST_OBJECTS = 2**24
"""Maximum size of the pickle in bytes, ten times the names and shapes of ten thousand tensors."""
MOST_PARTS = 100_000
"""Maximum number of parts in an archive or of values in a pickle, more than in any checkpoint."""

# Types saved by `normalgan fit` and Lightning's callbacks. With weights_only, torch also allows types such
# as bytearray, where a single number can allocate all memory.
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
_END = struct.Struct("<4s4H2LH")  # end of a zip file
_PLACE64 = struct.Struct("<4sLQL")  # locates the end record of a large zip file
_END64 = struct.Struct("<4sQ2H2L4Q")


def load_torch_file(path: Path) -> Any:
    """Load a `torch.save` file with memory-mapped tensors.

    Nothing in it is executed, and nothing is imported or allocated before the checks.

    Raises:
        InputError: if the file is missing or damaged, or holds anything but data.
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
    except Exception as error:  # torch raises anything on invalid bytes, with messages for programmers
        if wants_memory(error):
            raise RunError(f"there is too little memory to read {path}; close other programs.") from error
        raise InputError(
            f"{path} is damaged or no checkpoint; give one that `normalgan fit` saved."
        ) from None
    return content


class _RefusedError(Exception):
    """Reason for not loading a file, as part of a sentence."""


def _read_pickle(path: Path) -> bytes:
    """Return the pickle of an archive, after checking that its parts are not larger than the file."""
    with path.open("rb") as file:
        refuse_pointer(path, file.read(64))
        directory = _directory(file)
        with zipfile.ZipFile(file) as archive:
            # zipfile allows bytes before the archive and torch does not, so they would read different
            # content.
            if archive.start_dir != directory:
                raise _RefusedError("it is not an archive of torch")
            parts = archive.infolist()
            if any(part.compress_type != zipfile.ZIP_STORED for part in parts):
                raise _RefusedError("its parts are compressed, which torch never does")
            if len(parts) > MOST_PARTS or sum(part.file_size for part in parts) > path.stat().st_size:
                raise _RefusedError("its parts are longer than the file")
            names = [part.filename.lower() for part in parts]  # torch ignores case in the names of parts
            if len(set(names)) < len(names):
                raise _RefusedError("two of its parts have the same name")
            found = [part for part in parts if re.fullmatch(r"[^/]+/data\.pkl", part.filename)]
            if len(found) != 1 or found[0].file_size > _MOST_OBJECTS:
                raise _RefusedError("it is not an archive of torch")
            return archive.read(found[0])


def _directory(file: io.BufferedIOBase | Any) -> int:
    """Return the offset of the zip directory, which must end at the end of the file."""
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
    """Check that a pickle refers only to classes of plain data.

    Raises:
        _RefusedError: if it refers to anything else.
    """
    for operation, argument, _ in pickletools.genops(content):
        if operation.name == "GLOBAL":
            module, _, name = str(argument).partition(" ")
            if (module, name) not in _DATA and not (module == "torch" and _NUMBERS.fullmatch(name)):
                shown = re.sub(r"[^\w.]", "?", f"{module}.{name}")[:60]
                raise _RefusedError(f"it holds {shown}, and only numbers, strings and tensors are read")
        elif operation.name in {"STACK_GLOBAL", "INST", "EXT1", "EXT2", "EXT4", "PERSID"}:
            raise _RefusedError("it is a pickle that torch does not write")


def _check_tensors(content: Any, most: int) -> None:
    """Check that tensors are not larger than the file, because a view can repeat a single number."""
    taken = 0
    for tensor in _tensors(content):
        taken += tensor.numel() * tensor.element_size()
        if taken > 2 * most:  # twice, because weights may be tied
            raise _RefusedError("its tensors are larger than the file")


def _tensors(content: Any) -> Iterator[Tensor]:
    # Each object is visited once, because nested references could otherwise expand without end.
    seen, waiting = set(), [content]
    while waiting:
        value = waiting.pop()
        if isinstance(value, Tensor):
            yield value
        elif isinstance(value, dict | list | tuple | set) and id(value) not in seen:
            seen.add(id(value))
            waiting += [*value, *value.values()] if isinstance(value, dict) else [*value]
