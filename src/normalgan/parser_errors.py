"""Parser errors: what the parser says of a mistake in settings, many lines deep, as one sentence."""

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from normalgan.errors import InputError, brief, did_you_mean
from normalgan.limits import MOST_SETTINGS, load_yaml, read_bounded, yaml_excess
from normalgan.registry import Registry
from normalgan.shipped_configs import shipped_names

_KINDS = {
    "int": "a whole number",
    "float": "a number",
    "str": "text",
    "bool": "true or false",
    "NoneType": "null",
    "list": "a list",
    "Iterable": "a list",
    "dict": "a mapping",
}
"""What people call the types of Python that settings have."""
_FEW = 16
"""More names than this no one reads."""


def explain(message: str, plugins: Mapping[str, Registry[Any]], settings: Sequence[str] = ()) -> str:
    r"""Return what jsonargparse says of a mistake as one sentence, with what may have been meant.

    Args:
        message: several lines, each deeper into the types that were tried.
        plugins: the classes that can be named, by the last part of the setting that names one.
        settings: every setting there is, in dots.

    >>> explain('Parser key "data.size":\n  Expected a <class \'int\'>. Got value: large', {})
    'argument "data.size": expected a whole number, not large.'
    >>> explain("Subcommand 'fit' does not accept option 'data.sise'", {}, ["data.size"])
    'there is no setting data.sise. Did you mean data.size?'
    """
    found_keys = re.findall(r'Parser key "([^"]+)"(?: element (\d+))?:', message)
    key = ".".join(name for name, _ in found_keys)
    item = "".join(f", item {number}" for _, number in found_keys if number)
    where = f'argument "{key}"{item}: ' if key else ""
    registry = plugins.get(key.rpartition(".")[2])
    if found := re.search(r"(?:does not accept option|unrecognized arguments:) '?(?:--)?([^\s'=]+)", message):
        return f"there is no setting {found[1]}.{did_you_mean(found[1], settings)}"
    if found := re.search(r"Option '(.+?)' is not accepted(.*)", message):
        return f"{where}there is no setting {found[1]!r} in it.{found[2]}"
    if found := re.search(r"Expected a dot import path string: (.+)", message):
        return where + (_unknown(registry, found[1]) if registry else f"no class named {found[1]!r}.")
    if found := re.search(r"Problem with given class_path '(.+?)':\s+(?!\s|Parser key)(.+)", message):
        advice = f": {_unknown(registry, found[1].rpartition('.')[2])}" if registry else "."
        return f"{where}{found[1]} cannot be imported ({found[2]}){advice}"
    if found := re.search(r"Not a valid subclass of (\w+)", message):
        known = f"; known: {', '.join(registry.names())}" if registry else ""
        return f"{where}{_given(message)} is no {found[1]}{known}."
    if found := re.search(r"the following arguments are required: (.+)", message):
        return f"{where}missing: {found[1]}."
    wanted = list(dict.fromkeys(_wanted(message)))
    if key and wanted:
        return f"{where}expected {' or '.join(wanted)}, not {_given(message)}."
    return " ".join(message.replace(" - ", " ").split())


def refusal(error: Exception) -> str:
    r"""Return what a class says of settings that it does not take, in one sentence.

    jsonargparse tells it among the reasons why each of the other types a setting may have did not do.

    >>> tried = "Does not validate against any of the Union subtypes\n  - size is 0.\n  - Expected a None"
    >>> refusal(ValueError(tried))
    'size is 0.'
    >>> refusal(TypeError("width is missing\nlong story"))
    'width is missing'
    """
    if "Union subtypes" not in str(error):
        return brief(error)
    reasons = re.findall(r"^ *- (.+)$", str(error), re.MULTILINE)
    own = [reason for reason in reasons if not reason.startswith(("Expected", "Does not validate"))]
    return own[0] if own else brief(error)


def check_config(path: str | Path, sections: Iterable[str]) -> None:
    """Look at a configuration file before it is parsed: the parser names neither the file nor the line.

    Args:
        path: the file.
        sections: the keys that group settings.

    Raises:
        InputError: if it is missing, cannot be read, is not YAML, or is no mapping of settings.
    """
    try:
        text = read_bounded(Path(path), MOST_SETTINGS).decode("utf-8")
        if excess := yaml_excess(text):
            raise InputError(f"the configuration {path} {excess}; settings need no such thing.")
        content = load_yaml(text)
    except FileNotFoundError:
        names = shipped_names()
        hint = did_you_mean(str(path), names) or f" The package brings {', '.join(names)}."
        raise InputError(f"there is no configuration file {path}.{hint}") from None
    except OSError as error:
        raise InputError(f"the configuration {path} cannot be read: {error.strerror}.") from None
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise InputError(f"the configuration {path} is not YAML: {line}{error.problem}.") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise InputError(f"the configuration {path} is not a text in YAML.") from None
    if not isinstance(content, dict):
        raise InputError(
            f"the configuration {path} holds no settings; it must be like {{data: {{size: 64}}}}."
        )
    for section in sections:
        if section in content and not isinstance(content[section], (dict, str)):
            is_now = "is empty" if content[section] is None else f"is {content[section]!r}"
            raise InputError(f'"{section}" in the configuration {path} {is_now}; it must hold settings.')


def _unknown(registry: Registry[Any], name: str) -> str:
    if len(registry.names()) <= _FEW:
        return registry.explain_unknown(name)
    return f"no {registry.base.__name__} named {name!r}.{did_you_mean(name, registry.names())}"


def _wanted(message: str) -> Iterable[str]:
    """Yield what would have been right, in the words of `_KINDS` where there are any."""
    for text in re.findall(r"Expected an? (.+?)(?:\. Got value.*)?$", message, re.MULTILINE):
        if text.startswith(("path but", "dot import path")):
            continue
        named = re.fullmatch(r"<class '(?:\w+\.)*(\w+)'>", text)
        literal = re.fullmatch(r"typing\.Literal\[(.+)\]", text)
        yield (
            _KINDS.get(named[1], f"a {named[1]}")
            if named
            else f"one of {literal[1]}"
            if literal
            else f"a {text}"
        )


def _given(message: str) -> str:
    return str(re.findall(r"G(?:ot|iven) value: (.*)", message)[-1])
