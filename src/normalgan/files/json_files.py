"""JSON files that a user gives."""

import json
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.files.limits import read_bounded

__all__ = ["read_json"]


def read_json(path: Path, kind: str = "", like: str = "") -> Any:
    """Return the value that a JSON file holds.

    Args:
        path: the file.
        kind: its description in messages, such as ``the split file``.
        like: a sentence on the expected content, for a file that is not JSON.

    Raises:
        InputError: if the file cannot be read or is not JSON.
    """
    name = f"{kind} {path}".strip()
    try:
        return json.loads(read_bounded(path))
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{name} cannot be read: {error.strerror or brief(error)}.") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name} is not JSON ({brief(error)}){f'; {like}' if like else '.'}") from error
