"""normalgan completion: print a script that completes commands, settings and class names in a shell."""

import inspect
import re
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec

from jsonargparse import ArgumentParser, set_parsing_settings

from normalgan.cli.commands import OTHERS
from normalgan.cli.parsing.light_parser import LightParser
from normalgan.cli.training.help import COMMANDS
from normalgan.errors import InputError

_SHELLS = ("bash", "zsh", "tcsh")
"""The supported shells."""


def run(arguments: list[str]) -> int:
    """Print the completion script of a shell and return the exit code.

    Raises:
        InputError: if the shell is not supported, or shtab is not installed.
    """
    print(completion_script(build_parser().parse_args(arguments).shell))
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan completion",
        usage="%(prog)s bash|zsh|tcsh",
        description="Print a script that completes commands and settings in a shell.",
    )
    parser.add_argument("shell", choices=_SHELLS, help="which shell")
    return parser


def completion_script(shell: str, training: Sequence[str] = tuple(COMMANDS)) -> str:
    """Return the completion script for a shell; generating it takes seconds, but using it takes no time.

    Args:
        shell: one of `_SHELLS`.
        training: training commands to include; all other commands are always included.

    Raises:
        InputError: if shtab is not installed, or a plug-in has a parameter for plug-ins of its own kind.
    """
    if find_spec("shtab") is None:
        raise InputError("completion needs shtab; install it with pip install 'normalgan[completion]'.")
    # Imported here because lightning takes seconds to import.
    from normalgan.cli.discovery import REGISTRIES
    from normalgan.cli.training.command import training_parser

    # jsonargparse 4.53 would follow such a parameter without end; one that may be None it follows once.
    nested = [
        f"{plugin.__name__}({parameter})"
        for registry in REGISTRIES.values()
        for plugin in registry
        for parameter in _nested_in(plugin)
    ]
    if nested:
        raise InputError(
            f"completion cannot list plug-ins within plug-ins of their own kind: let {', '.join(nested)} "
            "be None too, as in `inner: HintSampler | None`."
        )
    whole = ArgumentParser(prog="normalgan")
    commands = whole.add_subcommands()
    for name in training:
        commands.add_subcommand(name, training_parser(name))
    for name, module in OTHERS.items():
        if module != __name__:
            commands.add_subcommand(name, import_module(module).build_parser())
    set_parsing_settings(subclasses_disabled=[_is_any_module])
    try:
        script: str = whole.get_completion_script(f"shtab-{shell}")
    finally:
        set_parsing_settings(subclasses_enabled=[_is_any_module.__name__])
    # jsonargparse completes full import paths, but users type class names.
    names = "|".join(name for registry in REGISTRIES.values() for name in registry.names())
    return re.sub(rf"\b(?:\w+\.)+({names})\b", r"\1", script)


def _nested_in(plugin: type) -> list[str]:
    """Return the parameters of a class that must be instances of a class that it derives from."""
    try:
        parameters = inspect.signature(plugin, eval_str=True).parameters.values()
    except NameError:  # a type that is imported for type checkers alone
        return []
    kinds = {given.name: given.annotation for given in parameters if isinstance(given.annotation, type)}
    return [name for name, kind in kinds.items() if issubclass(plugin, kind) and not _is_any_module(kind)]


def _is_any_module(cls: type) -> bool:
    """Return whether a parameter takes all of torch's modules, whose settings, and theirs, are not listed."""
    return f"{cls.__module__}.{cls.__qualname__}" == "torch.nn.modules.module.Module"
