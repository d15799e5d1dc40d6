"""Parser: Lightning's, with an answer to mistakes that people can use."""

import re
from argparse import HelpFormatter
from typing import NoReturn

from lightning.pytorch.cli import LightningArgumentParser

from normalgan.class_settings import OwnDefaultsParser
from normalgan.errors import InputError, did_you_mean
from normalgan.parser_errors import explain
from normalgan.plugins import SETTINGS, described, namable


class Parser(OwnDefaultsParser, LightningArgumentParser):
    """Says a mistake in one sentence, and names what a typo may have meant."""

    def error(self, message: str, ex: Exception | None = None) -> NoReturn:
        """Raise `InputError` in place of a usage page."""
        if self.exit_on_error:
            raise InputError(explain(message, namable(), self._settings())) from ex
        # The parser of a class that a setting names; what it says comes back as part of a longer message.
        unknown = re.fullmatch(r"Option '(.+)' is not accepted", message)
        super().error(message + (did_you_mean(unknown[1], self._settings()) if unknown else ""), ex)

    def format_help(self, formatter: HelpFormatter | None = None) -> str:
        """Return the help, opened by a usage in which nothing stands between program and command.

        That of a command ends with the plug-ins its settings can name.
        """
        self.prog = self.prog.replace(" [options]", "")
        names_plugins = {action.dest for action in self._actions} >= set(SETTINGS.values())
        return super().format_help(formatter) + (f"\n{described()}" if names_plugins else "")

    def _settings(self) -> list[str]:
        commands = [c for a in self._actions if isinstance(a.choices, dict) for c in a.choices.values()]
        return [action.dest for parser in (self, *commands) for action in parser._actions]


def given_configs(arguments: list[str]) -> list[str]:
    """Return the configuration files among the arguments, however they are spelled.

    >>> given_configs(["fit", "-c", "a.yaml", "--config=b.yaml", "-cc.yaml", "--data.size", "64"])
    ['a.yaml', 'b.yaml', 'c.yaml']
    """
    apart = {i + 1 for i, argument in enumerate(arguments) if argument in {"-c", "--config"}}
    found = []
    for i, argument in enumerate(arguments):
        joined = re.fullmatch(r"(?:--config=|-c(?!$))(.+)", argument)
        if i in apart or joined:
            found.append(joined[1] if joined and i not in apart else argument)
    return found
