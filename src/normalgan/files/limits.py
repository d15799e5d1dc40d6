"""Limits of reading, so that no file exhausts memory or time."""

import os
import stat
from pathlib import Path
from typing import Any

import yaml

from normalgan.errors import InputError, brief

__all__ = [
    "MOST_BYTES",
    "MOST_DEPTH",
    "MOST_NODES",
    "MOST_SETTINGS",
    "load_yaml",
    "read_bounded",
    "read_named",
    "refuse_pointer",
    "yaml_limit_error",
]

MOST_BYTES = 2**30
"""Larger files are refused; the largest scans in use have a tenth of it."""
MOST_SETTINGS = 2**18
"""Larger configurations are refused, in bytes: PyYAML takes seconds for each megabyte."""
MOST_DEPTH = 50
"""Deeper lists and mappings are refused; no settings need them."""
MOST_NODES = 100_000
"""More values are refused, those counted again that an alias repeats; no settings need as many."""
_POINTER = b"version https://git-lfs.github.com/spec/"
"""What a pointer of Git LFS begins with."""


def read_bounded(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return the bytes of a file within a limit.

    Raises:
        InputError: if there are more than ``most``, or it is a pipe, which may never end or never begin, or
            a device, or a pointer of Git LFS.
        OSError: if it cannot be read.
    """
    with open(path, "rb", opener=_without_waiting) as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"{path} is a pipe or a device; give a file.")
        # A sparse file of terabytes costs nothing to make: its size first, then its bytes.
        if status.st_size > most:
            raise InputError(f"{path} has more than {most} bytes; no file of its kind is that large.")
        data = file.read(status.st_size)
    refuse_pointer(path, data)
    return data


def read_named(path: Path, kind: str = "", most: int = MOST_BYTES) -> bytes:
    """Return the bytes of a file that a user named, as `read_bounded` does.

    Args:
        path: the file.
        kind: its description in messages, such as ``the split file``.
        most: largest number of bytes.

    Raises:
        InputError: if it cannot be read.
    """
    try:
        return read_bounded(path, most)
    except OSError as error:
        reason = error.strerror or brief(error)
        raise InputError(f"{f'{kind} {path}'.strip()} cannot be read: {reason}.") from error


def refuse_pointer(path: Path | str, data: bytes) -> None:
    """Refuse a Git LFS pointer: a large file that was not fetched.

    Args:
        path: the file, or its name in messages.
        data: its content, or the beginning of it.

    Raises:
        InputError: if it is a pointer of Git LFS.
    """
    if data.startswith(_POINTER):
        raise InputError(
            f"{path} is a Git LFS pointer and not the file itself; run `git lfs pull` in its repository."
        )


def _without_waiting(path: str, flags: int) -> int:
    """Open a file without waiting for the writer of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def yaml_limit_error(text: str) -> str | None:
    r"""Return which limit a YAML text exceeds, as the end of a sentence; None if it may be loaded.

    Aliases count as if they were expanded, because ten lines can stand for billions of values.

    Raises:
        yaml.YAMLError: if it is not YAML.

    >>> yaml_limit_error("a: &a [1, 2]\nb: [*a, *a]")
    >>> yaml_limit_error("a: &a [*a]")
    'contains itself, at *a'
    """
    sizes: dict[str, int] = {}  # of what each anchor names
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
    """Return the value of a YAML text, loaded safely; ask `yaml_limit_error` first.

    Raises:
        yaml.MarkedYAMLError: with the line, also for a key that a mapping has twice, and for what looks like
            a date or a number and is none, where PyYAML raises a bare ValueError or worse.

    >>> load_yaml("a: 2026-02-30")
    Traceback (most recent call last):
    yaml.constructor.ConstructorError: 2026-02-30 looks like a number or a date, but is none; put it in quotes
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
                # PyYAML would take the last one and drop the others, with all that is in them.
                if key.value in first:
                    problem = f"{key.value:.40} was given in line {first[key.value]} already"
                    raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
                first[key.value] = key.start_mark.line + 1
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, AttributeError) as error:
            problem = f"{node.value:.40} looks like a number or a date, but is none; put it in quotes"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark) from error
