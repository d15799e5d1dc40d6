"""JSON files that a user gives."""

import json
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.files.limits import read_named

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
    content = read_named(path, kind)
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        name, end = f"{kind} {path}".strip(), f"; {like}" if like else "."
        raise InputError(f"{name} is not JSON ({brief(error)}){end}") from error
