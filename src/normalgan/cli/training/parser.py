"""Parser: Lightning's parser with readable error messages."""

import re
from argparse import HelpFormatter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from enum import Enum
from typing import Any

import torch
from jsonargparse import Namespace
from lightning.pytorch.cli import LightningArgumentParser

from normalgan.cli.discovery import SETTINGS, described, namable
from normalgan.cli.parsing.light_parser import OwnDefaultsParser
from normalgan.registry import Registry

_section: ContextVar[str | None] = ContextVar("_section", default=None)


@contextmanager
def help_of(section: str | None) -> Iterator[None]:
    """Restrict ``--help`` to the settings of one section within the context; None lists all."""
    token = _section.set(section)
    try:
        yield
    finally:
        _section.reset(token)


_RANGED = re.compile(r"Annotated\[(\w+(?:\[[\w,\s]*\])?),(\s+[^\[\]]*)\]")
"""Pattern of types with a range, from which ``--help`` drops the word Annotated."""


class Parser(OwnDefaultsParser, LightningArgumentParser):
    """The parser of a training command, whose errors and help list the plug-ins."""

    def _plugins(self) -> Mapping[str, Registry[Any]]:
        return namable()

    def dump(self, cfg: Any, *given: Any, **how: Any) -> str:
        """Return settings as text without validating them again, which would take a tenth of parsing."""
        if "skip_none" in how:  # Lightning's name for it, which jsonargparse has renamed
            how["skip_unset"] = how.pop("skip_none")
        text: str = super().dump(_as_text(cfg), *given, **{"skip_validation": True, **how})
        return text

    def format_help(self, formatter: HelpFormatter | None = None) -> str:
        """Return the help, which ends with the plug-ins that the command's settings can name.

        Within `help_of`, only one section is shown.
        """
        dests = {action.dest for action in self._actions}
        section, groups = _section.get(), self._action_groups
        if section is not None and any(dest.startswith(f"{section}.") for dest in dests):
            self._action_groups = [
                group
                for group in groups
                if any(action.dest.partition(".")[0] == section for action in group._group_actions)
            ]
        try:
            text = super().format_help(formatter)
        finally:
            self._action_groups = groups
        text = _RANGED.sub(r"\1,\2", text)
        if not dests >= set(SETTINGS.values()):
            return text
        plugins = described(section or "")
        return f"{text}\n{plugins}" if plugins else text


def _as_text(settings: Any) -> Any:
    """Return a copy of settings in which enumerations and devices are strings.

    Callbacks of Lightning have such defaults, as `Timer` and `StochasticWeightAveraging` do. YAML cannot
    represent them.
    """
    if isinstance(settings, Namespace):
        copy = settings.clone()
        vars(copy).update({name: _as_text(value) for name, value in vars(settings).items()})
        return copy
    if isinstance(settings, dict):
        return {name: _as_text(value) for name, value in settings.items()}
    if type(settings) in {list, tuple}:
        return type(settings)(map(_as_text, settings))
    if isinstance(settings, Enum):
        return settings.value
    return str(settings) if isinstance(settings, torch.device) else settings
