"""Settings of the classes that a command is given: a class that is named starts from its own defaults.

jsonargparse carries a setting of the former class over where the new one has one of that name too, be it a
value that somebody gave or the former class's default (https://github.com/mauvilsa/jsonargparse/issues/460):
a brush was drawn with the line width of another style, without a word.
"""

import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import groupby
from typing import Any

from jsonargparse import ArgumentParser, Namespace, _typehints

__all__ = ["OwnDefaultsParser", "classes_first"]

_ours: ContextVar[bool] = ContextVar("_ours", default=False)
_carry_over = _typehints.discard_init_args_on_class_path_change  # raises if it is not called so any more


def _start_anew(parser_or_action: Any, prev_val: Any, value: Any) -> None:
    """Drop all settings of the former class where another class is named; else do what jsonargparse does."""
    if not _ours.get():
        _carry_over(parser_or_action, prev_val, value)  # type: ignore[no-untyped-call]
    elif prev_val and "init_args" in prev_val and not _same(prev_val["class_path"], value["class_path"]):
        former = prev_val["init_args"]
        for key in list(vars(former) if isinstance(former, Namespace) else former):
            former.pop(key)


_typehints.discard_init_args_on_class_path_change = _start_anew


def _same(one: str | None, other: str | None) -> bool:
    """Return whether two import paths lead to one class; nothing is imported for it."""
    return one == other or (one is not None and other is not None and _loaded(one) is _loaded(other))


def _loaded(path: str) -> object:
    module, _, name = path.rpartition(".")
    return getattr(sys.modules.get(module), name, path)


@contextmanager
def _own_defaults() -> Iterator[None]:
    token = _ours.set(True)
    try:
        yield
    finally:
        _ours.reset(token)


class OwnDefaultsParser(ArgumentParser):
    """Lets each class that is named start from its own defaults, on the command line and in files."""

    def parse_args(self, args: Sequence[str] | None = None, *more: Any, **settings: Any) -> Any:  # type: ignore[override]
        """Parse a command line; settings that stand before their class are given to it all the same."""
        with _own_defaults():
            return super().parse_args(None if args is None else classes_first(list(args)), *more, **settings)

    def parse_object(self, *given: Any, **settings: Any) -> Any:
        """Parse settings that are given as dictionaries."""
        with _own_defaults():
            return super().parse_object(*given, **settings)


def classes_first(arguments: Sequence[str]) -> list[str]:
    """Return the arguments with each class before the settings that stand before it.

    A file in between, or in place of the class, wins over what stands before it, as everywhere.

    >>> classes_first(["--lines.line_width", "3", "--size=64", "--lines", "Brush"])
    ['--size=64', '--lines', 'Brush', '--lines.line_width', '3']
    """
    options: list[list[str]] = []
    for argument in arguments:
        if re.match(r"--?[A-Za-z]", argument) or not options:
            options.append([])
        options[-1].append(argument)
    ordered: list[list[str]] = []
    for _, group in groupby(options, lambda option: option[0].partition("=")[0] in {"-c", "--config"}):
        part = list(group)
        for i in reversed(range(len(part))):
            of = [j for j, option in enumerate(part) if _names_class_of(option, part[i])]
            if of and of[0] > i:
                part.insert(of[-1], part.pop(i))
        ordered += part
    return [argument for option in ordered for argument in option]


def _names_class_of(option: list[str], setting: list[str]) -> bool:
    """Return whether an option, such as ``--lines Brush``, names the class that a setting is of."""
    name, _, value = " ".join(option).replace(" ", "=", 1).partition("=")
    return setting[0].startswith(f"{name}.") and not value.endswith((".yaml", ".yml", ".json"))
