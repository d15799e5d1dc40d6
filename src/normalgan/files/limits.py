"""Limits on reading, so that no file exhausts memory or time."""

import os
import stat
from pathlib import Path
from typing import Any

import yaml

from normalgan.errors import InputError, brief

MOST_BYTES = 2**30
"""Maximum file size in bytes, ten times the largest scans in use."""
MOST_SETTINGS = 2**18
"""Maximum size of a configuration in bytes; PyYAML takes seconds per megabyte."""
MOST_DEPTH = 50
"""Maximum nesting depth of lists and mappings, more than any settings need."""
MOST_NODES = 100_000
"""Maximum number of values, counting each expansion of an alias; more than any settings need."""
_POINTER = b"version https://git-lfs.github.com/spec/"
"""First bytes of a Git LFS pointer."""


def read_bounded(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return the content of a file, up to a size limit.

    Raises:
        InputError: if the file has more than ``most`` bytes, or is a pipe, a device or a Git LFS pointer.
            A pipe may block forever.
        OSError: if the file cannot be read.
    """
    with open(path, "rb", opener=_without_waiting) as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"{path} is a pipe or a device; give a file.")
        # The size is checked before reading, because a sparse file of terabytes is easily made.
        if status.st_size > most:
            raise InputError(f"{path} has more than {most} bytes; no file of its kind is that large.")
        data = file.read(status.st_size)
    refuse_pointer(path, data)
    return data


def read_named(path: Path, kind: str = "", most: int = MOST_BYTES) -> bytes:
    """Return the content of a file given by the user, as `read_bounded` does.

    Args:
        path: path of the file.
        kind: description of the file in messages, such as ``the split file``.
        most: maximum number of bytes.

    Raises:
        InputError: if the file cannot be read.
    """
    try:
        return read_bounded(path, most)
    except OSError as error:
        reason = error.strerror or brief(error)
        raise InputError(f"{f'{kind} {path}'.strip()} cannot be read: {reason}.") from error


def refuse_pointer(path: Path | str, data: bytes) -> None:
    """Refuse a Git LFS pointer, which stands for a large file that was not downloaded.

    Args:
        path: path of the file, or its name in messages.
        data: content of the file, or its beginning.

    Raises:
        InputError: if the file is a Git LFS pointer.
    """
    if data.startswith(_POINTER):
        raise InputError(
            f"{path} is a Git LFS pointer and not the file itself; run `git lfs pull` in its repository."
        )


def _without_waiting(path: str, flags: int) -> int:
    """Open a file without blocking on a pipe that has no writer."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def yaml_limit_error(text: str) -> str | None:
    r"""Return the limit that a YAML text exceeds, as the end of a sentence, or None if it is safe to load.

    Aliases count as expanded, because ten lines can stand for billions of values.

    Raises:
        yaml.YAMLError: if the text is not YAML.

    >>> yaml_limit_error("a: &a [1, 2]\nb: [*a, *a]")
    >>> yaml_limit_error("a: &a [*a]")
    'contains itself, at *a'
    """
    sizes: dict[str, int] = {}  # of each anchor's node
    open_anchors: list[str | None] = [None]
    counts = [0]
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if isinstance(event, yaml.CollectionStartEvent):
            open_anchors.append(event.anchor)
            counts.append(1)
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, count = open_anchors.pop(), counts.pop()
            counts[-1] += count
            if anchor is not None:
                sizes[anchor] = count
        elif isinstance(event, yaml.AliasEvent):
            if event.anchor in open_anchors:
                return f"contains itself, at *{event.anchor}"
            counts[-1] += sizes.get(str(event.anchor), 1)
        elif isinstance(event, yaml.ScalarEvent):
            counts[-1] += 1
        if len(counts) > MOST_DEPTH:
            return f"is nested more than {MOST_DEPTH} deep"
        if sum(counts) > MOST_NODES:
            return f"stands for more than {MOST_NODES} values"
    return None


def load_yaml(text: str) -> Any:
    """Return the value of a YAML text, loaded safely; call `yaml_limit_error` first.

    Raises:
        yaml.MarkedYAMLError: with the line, if the text is invalid, if a mapping has a duplicate key, or
            for an invalid date or number, where PyYAML raises a bare ValueError or worse.

    >>> load_yaml("a: 2026-02-30")
    Traceback (most recent call last):
    yaml.constructor.ConstructorError: 2026-02-30 is not a valid number or date; put it in quotes
      in "<unicode string>", line 1, column 4:
        a: 2026-02-30
           ^
    """
    return yaml.load(text, _Loader)


class _Loader(yaml.SafeLoader):
    def compose_mapping_node(self, anchor: dict[Any, yaml.Node]) -> yaml.MappingNode:
        node = super().compose_mapping_node(anchor)
        first: dict[str, int] = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and key.tag != "tag:yaml.org,2002:merge":
                # PyYAML would keep the last value of a duplicate key and silently drop the others.
                if key.value in first:
                    problem = f"{key.value:.40} was given in line {first[key.value]} already"
                    raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
                first[key.value] = key.start_mark.line + 1
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, AttributeError) as error:
            problem = f"{node.value:.40} is not a valid number or date; put it in quotes"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark) from error
