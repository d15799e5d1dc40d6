"""LightParser: for the commands that need no Lightning; it answers mistakes as those do that train."""

from collections.abc import Mapping
from typing import Any, NoReturn

from normalgan.cli.class_settings import OwnDefaultsParser
from normalgan.cli.parser_errors import explain
from normalgan.errors import InputError
from normalgan.registry import Registry

__all__ = ["LightParser"]


class LightParser(OwnDefaultsParser):
    """Says a mistake in one sentence, and names what a typo may have meant."""

    plugins: Mapping[str, Registry[Any]] = {}
    """The registry behind each setting that names a plug-in."""

    def error(self, message: str, ex: Exception | None = None) -> NoReturn:
        """Raise `InputError` in place of a usage page."""
        if self.exit_on_error:
            raise InputError(
                explain(message, self.plugins, [action.dest for action in self._actions])
            ) from ex
        super().error(message, ex)
