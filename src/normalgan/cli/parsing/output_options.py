"""Output options: add an option for every registered output to the commands that write normal maps."""

import argparse
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, Literal, NamedTuple, get_type_hints

from docstring_parser import DocstringStyle, parse

from normalgan.cli.parsing.light_parser import choices
from normalgan.errors import InputError
from normalgan.inference.normal_map import Format
from normalgan.inference.outputs import OUTPUTS, Normal, Output
from normalgan.inference.outputs.output_set import option_of, settings_of
from normalgan.registry import summary


class _Option(NamedTuple):
    name: str
    type: Any
    default: Any
    help: str


def add_output_options(
    group: argparse._ArgumentGroup, section: str = "", form: Format | None = "png"
) -> None:
    """Add the options that `outputs_of` reads.

    Args:
        group: argument group in the help.
        section: prefix of the option names, such as ``output.``; empty uses command-line spelling.
        form: default format of the map; None uses the ending of the output file.

    Raises:
        InputError: if the name of a plug-in's option is already taken.
    """
    formats: Any = Format if form else Format | None
    form_help = _descriptions(Normal)["format"].rstrip(".")
    group.add_argument(
        f"--{section}format", type=formats, default=form, metavar=choices(formats), help=form_help
    )
    for kind in (Normal, *OUTPUTS):
        for option in _options(kind):
            if section and option.name == "engine":
                continue  # it changes defaults, which only generate supports
            name = option.name if section else option.name.replace("_", "-")
            flag = option.type is bool and not section
            how: dict[str, Any] = {"action": "store_true"}
            if not flag:
                how = {"type": option.type, "default": option.default, "metavar": choices(option.type)}
            said = "" if section or option.default in {None, False} else f" (default {option.default})"
            try:
                group.add_argument(f"--{section}{name}", help=f"{option.help}{said}", **how)
            except (argparse.ArgumentError, ValueError):
                raise InputError(
                    f"the output {kind.__name__} has an option --{name}, and so has the command; "
                    "its author has to rename it. Until then, uninstall it."
                ) from None


def _options(kind: type[Output]) -> Iterator[_Option]:
    descriptions, types = _descriptions(kind), get_type_hints(kind)
    if kind is not Normal:
        formats, name = kind.formats(), f"<sketch>_{kind.name}"
        what = summary(kind).rstrip(".")
        words = f"write {what[0].lower()}{what[1:]}"
        if len(formats) > 1:
            asked: Any = Literal[formats] | None
            yield _Option(
                option_of(kind),
                asked,
                None,
                f"{words}: {descriptions.get('format', 'the format').rstrip('.')}",
            )
        else:
            yield _Option(option_of(kind), bool, False, f"{words}, {name}.{formats[0]}")
    defaults = {field.name: field.default for field in fields(kind)}
    for name in settings_of(kind):
        yield _Option(name, types[name], defaults[name], descriptions.get(name, "").rstrip("."))


def _descriptions(kind: type[Output]) -> dict[str, str]:
    """Return the descriptions of an output's settings, from its docstring."""
    found = parse(kind.__doc__ or "", style=DocstringStyle.GOOGLE).params
    return {each.arg_name: " ".join((each.description or "").split()) for each in found}
