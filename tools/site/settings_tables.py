"""Makes Markdown tables of settings, with the contents of --help, from the parsers of the command line."""

import re
from argparse import SUPPRESS, Action
from collections.abc import Iterable
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from jsonargparse import ArgumentParser, Namespace

HIDDEN = {"help", "config", "print_config"}
LONGEST_HELP = 330
"""Length from which only the beginning of a sentence is shown."""
HEAD = "| setting | takes | default | |\n| --- | --- | --- | --- |\n"


def table(parser: ArgumentParser, prefix: str = "", bare: bool = False) -> str:
    """Return a table of a parser's settings with a prefix; empty if there are none.

    Args:
        parser: the parser of a command or a class.
        prefix: prefix of a group of settings, such as ``data.``, which their names omit.
        bare: whether the names omit the dashes.
    """
    unsaid = "--" if bare else prefix and f"--{prefix}"
    rows = []
    for action in _settings(parser):
        if action.dest.startswith(prefix):
            cells = (_names(action, unsaid), _takes(action), _default(action, parser), _sentence(action))
            rows.append(f"| {' | '.join(cells)} |")
    return HEAD + "\n".join(rows) + "\n" if rows else ""


def class_table(cls: type[Any]) -> str:
    """Return a table of a class's settings; empty if it has none."""
    parser = ArgumentParser(exit_on_error=False)
    parser.add_class_arguments(cls)
    return table(parser, bare=True)


def _settings(parser: ArgumentParser) -> Iterable[Action]:
    for action in parser._actions:
        name = action.dest.rsplit(".", 1)[-1]
        internal = action.help == SUPPRESS or name in HIDDEN or name.endswith("help")
        linked = "-->" in "".join(action.option_strings) or "-->" in action.dest
        if not (internal or linked or action.help == "Path to a configuration file."):
            yield action


def _names(action: Action, prefix: str) -> str:
    names = [name for name in action.option_strings if not name.endswith("+")]  # += appends to a list
    if prefix:
        names = [name.removeprefix(prefix) for name in names]
    return ", ".join(f"`{name}`" for name in names) or f"`{action.dest.upper()}`"


def _takes(action: Action) -> str:
    if action.choices:
        return ", ".join(f"`{choice}`" for choice in action.choices)
    hint = getattr(action, "_typehint", None) or action.type
    if hint is None:
        return "nothing" if action.nargs == 0 else "`text`"
    return f"`{plain_type(hint)}`"


def plain_type(hint: Any) -> str:
    """Return the name of a type for a reader of YAML.

    >>> plain_type(list[str] | None)
    'list[text] or null'
    """
    if hint is None or hint is type(None):
        return "null"
    origin, inside = get_origin(hint), get_args(hint)
    if origin in {Union, UnionType}:
        return " or ".join(plain_type(each) for each in inside)
    if origin is Annotated:  # a range
        return f"{plain_type(inside[0])}, {inside[1]}"
    if origin is Literal:
        return " or ".join(str(each) for each in inside)
    if origin in {list, tuple, dict} and inside:
        parts = ", ".join("…" if each is Ellipsis else plain_type(each) for each in inside)
        return f"{origin.__name__}[{parts}]"
    if origin is not None:  # Callable[…, Optimizer], Iterable[…]: the result or the element
        return plain_type(inside[-1]) if inside else getattr(origin, "__name__", str(origin))
    name = getattr(hint, "__name__", str(hint).rsplit(".", 1)[-1])
    return {"str": "text", "bool": "true or false", "int": "whole number", "float": "number"}.get(name, name)


def _default(action: Action, parser: ArgumentParser) -> str:
    if not action.option_strings and action.nargs != "?":
        return "needed"
    value = parser.get_defaults().get(action.dest, action.default)
    if isinstance(value, Namespace):
        value = value.as_dict()
    if isinstance(value, dict) and "class_path" in value:
        value = value["class_path"].rsplit(".", 1)[-1]
    elif isinstance(value, tuple):
        value = list(value)
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else str(value)
    return "`null`" if value is None else f"`{text}`" if text else "empty"


def _sentence(action: Action) -> str:
    text = " ".join((action.help or "").split()).replace("``", "`").removesuffix(" (required)")
    if len(text) > LONGEST_HELP:  # a library's text, which its own pages show in full
        sentences = re.split(r"(?<=\.)\s|\s(?=\.\. )|\s(?=- )", text)
        text = next(sentence for sentence in sentences if not sentence.startswith("Defaults to"))
    text = re.sub(r"`?\bNone\b`?", "`null`", text)
    return text.replace("|", r"\|").replace("<", "&lt;")
