"""Safe loading of files by `torch.save`: data only, nothing in them is run."""

from pathlib import Path
from typing import Any

import torch

from normalgan.errors import InputError, RunError, wants_memory
from normalgan.files.limits import refuse_pointer

__all__ = ["load_torch_file"]


def load_torch_file(path: Path) -> Any:
    """Load a file of `torch.save`; tensors are memory-mapped.

    Raises:
        InputError: if it is missing, damaged, or holds anything but data.
    """
    if not path.is_file():
        raise InputError(f"there is no checkpoint {path}.")
    try:
        with path.open("rb") as file:
            refuse_pointer(path, file.read(64))
        return torch.load(path, map_location="cpu", weights_only=True, mmap=True)
    except PermissionError:
        raise InputError(f"the checkpoint {path} may not be read; change its permissions.") from None
    except InputError:
        raise
    except Exception as error:  # whatever torch raises on other bytes; what it says is advice for programmers
        if wants_memory(error):
            raise RunError(f"there is too little memory to read {path}; close other programs.") from error
        raise InputError(
            f"{path} is damaged or no checkpoint; give one that `normalgan fit` saved."
        ) from None
