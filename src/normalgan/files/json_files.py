"""JSON files: reading those that users give, and the form of those that the package writes."""

import json
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.files.limits import read_named


def read_json(path: Path, kind: str = "", like: str = "") -> Any:
    """Return the value in a JSON file.

    Args:
        path: path of the file.
        kind: description of the file in messages, such as ``the split file``.
        like: sentence on the expected content, for the message if the file is not JSON.

    Raises:
        InputError: if the file cannot be read or is not JSON.
    """
    content = read_named(path, kind)
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        name, end = f"{kind} {path}".strip(), f"; {like}" if like else "."
        raise InputError(f"{name} is not JSON ({brief(error)}){end}") from error


def encode_json(value: Any) -> bytes:
    r"""Return the content of a JSON file, indented so that people can read it.

    >>> encode_json({"samples": 3})
    b'{\n "samples": 3\n}\n'
    """
    return (json.dumps(value, indent=1) + "\n").encode()
