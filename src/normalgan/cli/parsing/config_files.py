"""Configuration files: check them before the parser reads them."""

import os
import re
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import yaml

from normalgan.errors import InputError, did_you_mean
from normalgan.files.limits import MOST_SETTINGS, load_yaml, read_named, yaml_limit_error
from normalgan.files.shipped_configs import find_config, shipped_folder, shipped_names

_VARIABLE = re.compile(r"\$\{([^{}]*)\}")


def check_config(path: str | Path, sections: Collection[str] = ()) -> None:
    """Check a configuration file.

    Args:
        path: path of the file.
        sections: keys that must hold groups of settings.

    Raises:
        InputError: if the file is missing, cannot be read, is not YAML, holds no settings, or is too large or
            too deeply nested.
    """
    content = _read(Path(path))
    if not isinstance(content, dict):
        raise InputError(
            f"the configuration {path} holds no settings; it must be like {{data: {{size: 64}}}}."
        )
    if sections and not {"rows", "base"}.isdisjoint(content):
        raise InputError(f"{path} is a benchmark plan; pass it to normalgan benchmark --config.")
    for section in sections:
        if section in content and not isinstance(content[section], (dict, str)):
            is_now = "is empty" if content[section] is None else f"is {content[section]!r}"
            raise InputError(f'"{section}" in the configuration {path} {is_now}; it must hold settings.')


def load_bounded(text: str, load: Callable[[str], Any], safe: bool = False) -> Any:
    """Return the content of a YAML text from a file or an argument.

    Args:
        text: YAML text.
        load: the parser's own YAML loader, which has its own rules for numbers.
        safe: whether reading environment variables, which may hold secrets, is refused.

    Raises:
        InputError: if the text is too large when expanded, or names a variable that cannot be read.
    """
    # Most texts are a word or a number. A short text without an anchor cannot expand to much.
    if "&" in text or len(text) > 100:
        if len(text) > MOST_SETTINGS:
            raise InputError(f"a setting has more than {MOST_SETTINGS} bytes, which is the limit.")
        if excess := yaml_limit_error(text):
            raise InputError(f"a setting {excess}; simplify it.")
    loaded = load(text)
    return with_environment(loaded, safe) if "${" in text else loaded


def with_environment(value: Any, safe: bool = False) -> Any:
    """Return settings with ``${NAME}`` replaced by the environment variable of that name.

    OmegaConf's ``${oc.env:NAME}`` and ``${oc.env:NAME,default}`` are supported too.

    Args:
        value: settings as nested lists and mappings.
        safe: whether reading environment variables is refused.

    Raises:
        InputError: if a variable is not set, or the braces hold something else.
    """
    if isinstance(value, dict):
        return {key: with_environment(item, safe) for key, item in value.items()}
    if isinstance(value, list):
        return [with_environment(item, safe) for item in value]
    return _VARIABLE.sub(lambda found: _variable(found, safe), value) if isinstance(value, str) else value


def with_shipped_configs(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Return the arguments with each configuration normalised to ``--config=PATH``, and the paths.

    Args:
        arguments: arguments of a command; ``--config`` may have any spelling and may name a shipped
            configuration.

    >>> given = ["fit", "-c", "a.yaml", "--config=b.yaml", "-cc.yaml", "--data.size", "64"]
    >>> with_shipped_configs(given)[0]
    ['fit', '--config=a.yaml', '--config=b.yaml', '--config=c.yaml', '--data.size', '64']
    """
    replaced, found = [], []
    words = iter(arguments)
    for word in words:
        joined = re.fullmatch(r"(?:--config=|-c(?!$))(.+)", word)
        given = joined[1] if joined else next(words, None) if word in {"-c", "--config"} else None
        if given is None:
            replaced.append(word)
            continue
        found.append(find_config(given))
        replaced.append(f"--config={found[-1]}")
    return replaced, found


def _variable(found: re.Match[str], safe: bool) -> str:
    if safe:
        raise InputError(f"a configuration reads {found[0][:60]}, which --safe-config does not allow.")
    named = re.fullmatch(r"(oc\.env:)?\s*([A-Za-z_]\w*)\s*(?:,(.*))?", found[1])
    if named is None or (named[3] is not None and not named[1]):
        raise InputError(
            f"{found[0][:60]} is not an environment variable; write ${{NAME}} or ${{oc.env:NAME,default}}."
        )
    value = os.environ.get(named[2], named[3])
    if value is None:
        raise InputError(f"{found[0][:60]} cannot be read: the environment has no {named[2]}.")
    return value


def _read(path: Path) -> Any:
    """Return the content of a configuration file."""
    if not path.exists():
        names, given = shipped_names(), path.with_suffix("")
        hint = did_you_mean(given.as_posix(), names) or did_you_mean(given.name, names)
        hint = hint or f" The shipped ones, such as paper and quickstart, are in {shipped_folder()}."
        raise InputError(f"there is no configuration file {path}.{hint}")
    try:
        text = read_named(path, "the configuration", MOST_SETTINGS).decode("utf-8")
        if excess := yaml_limit_error(text):
            raise InputError(f"the configuration {path} {excess}; simplify it.")
        return load_yaml(text)
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        problem = str(error.problem)
        if problem.startswith("but"):  # "expected a single document", "but found another document"
            problem = f"{error.context} {problem}"
        advice = "; indent with spaces" if r"'\t'" in problem else ""
        raise InputError(f"the configuration {path} is not YAML: {line}{problem}{advice}.") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise InputError(f"the configuration {path} is not YAML text.") from None
