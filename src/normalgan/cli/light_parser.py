"""LightParser: the parser of commands without Lightning, with the same error messages as `Parser`."""

import argparse
from collections.abc import Mapping
from types import UnionType
from typing import Any, Literal, NoReturn, Union, get_args, get_origin

from normalgan.cli.class_settings import OwnDefaultsParser
from normalgan.cli.parser_errors import explain
from normalgan.errors import InputError
from normalgan.registry import Registry

__all__ = ["LightParser", "choices"]


class LightParser(OwnDefaultsParser):
    """Reports mistakes in one sentence, with a suggestion for typos."""

    plugins: Mapping[str, Registry[Any]] = {}
    """The registry behind each setting that names a plug-in."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        # jsonargparse's own formatter adds the type of each option in Python's notation.
        super().__init__(*args, formatter_class=argparse.HelpFormatter, **settings)

    def error(self, message: str, ex: Exception | None = None) -> NoReturn:
        """Raise `InputError` instead of printing a usage page."""
        if self.exit_on_error:
            raise InputError(
                explain(message, self.plugins, [action.dest for action in self._actions])
            ) from ex
        super().error(message, ex)


def choices(kind: Any) -> str | None:
    """Return how ``--help`` shows an option's value: its choices; None if it also takes other values.

    >>> choices(Literal["png", "exr"] | None), choices(Literal["batch"] | float)
    ('{png,exr}', None)
    """
    kinds = get_args(kind) if get_origin(kind) in {Union, UnionType} else (kind,)
    named = [each for each in kinds if each is not type(None)]
    if not named or any(get_origin(each) is not Literal for each in named):
        return None
    return f"{{{','.join(str(word) for each in named for word in get_args(each))}}}"
