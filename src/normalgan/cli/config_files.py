"""Configuration files: looked at before the parser reads them, and imports what they name."""

import importlib.util
import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from normalgan.errors import InputError, did_you_mean
from normalgan.files.limits import MOST_SETTINGS, load_yaml, read_bounded, yaml_limit_error
from normalgan.files.shipped_configs import shipped_folder, shipped_names

__all__ = ["ConfigCheck", "load_bounded"]

_DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)+")
_STRUCTURE = re.compile(r"[\[{:\n]")  # what a text in YAML has that stands for more than itself
_YAML = (".yaml", ".yml")


@dataclass
class ConfigCheck:
    """A look at configuration files and at all files that they name to be read in their place.

    Args:
        sections: the keys that group settings; a file may stand for a group.
        classes: the keys that take a class, or a file that names one.
        allowed: tells of the name of a class whether a stranger's configuration may name it; None allows
            any, and takes a configuration for the program that it is.
    """

    sections: Collection[str]
    classes: Collection[str] = ()
    allowed: Callable[[str], bool] | None = None
    _seen: set[Path] = field(default_factory=set)

    def check(self, path: str | Path) -> None:
        """Look at a file.

        Raises:
            InputError: if it or one that it names is missing, cannot be read, is not YAML, is no mapping of
                settings, wants too much, or names what is not allowed.
        """
        content = _read(Path(path))
        if not isinstance(content, dict):
            raise InputError(
                f"the configuration {path} holds no settings; it must be like {{data: {{size: 64}}}}."
            )
        if self.sections and not {"rows", "base"}.isdisjoint(content):
            raise InputError(f"{path} is a plan of a comparison; give it to normalgan benchmark --config.")
        for section in self.sections:
            if section in content and not isinstance(content[section], (dict, str)):
                is_now = "is empty" if content[section] is None else f"is {content[section]!r}"
                raise InputError(f'"{section}" in the configuration {path} {is_now}; it must hold settings.')
        self._look_into(content, Path(path))

    def check_arguments(self, arguments: Collection[str]) -> None:
        """Look at the files that stand for a section or a class on the command line.

        Raises:
            InputError: as `check` does.
        """
        words = iter(arguments)
        for word in words:
            found = re.fullmatch(r"--([\w.]+)\+?(?:=(.*))?", word, re.DOTALL)
            if found and found[1].rpartition(".")[2] in {*self.sections, *self.classes}:
                value = found[2] if found[2] is not None else next(words, "")
                self._look_at_file(found[1], value, Path())

    def _look_into(self, content: Any, path: Path) -> None:
        for key, value in _values(content, ""):
            name = key.rstrip("+").rpartition(".")[2]
            if isinstance(value, str):
                self._look_at_file(name, value, path)
                if self.allowed is not None:
                    self._check_text(name, value, path, self.allowed)
            if self.allowed is not None and value and name in {"dict_kwargs", "cluster"}:
                raise InputError(
                    f"the configuration {path} sets {name}, which --safe-config does not allow; give it on "
                    "the command line, once you know what it does."
                )

    def _look_at_file(self, name: str, value: str, path: Path) -> None:
        """Look at a file that is named, if the parser would read it in place of a value."""
        group = name in self.sections or name in self.classes
        for folder in (path.parent, Path()):
            there = folder / value
            try:
                if not value or there.is_dir() or not there.exists():
                    continue
            except (OSError, ValueError):  # no name of a file at all
                return
            if not there.is_file():
                raise InputError(f"{name} names {there}, which is no file.")
            if (group or there.suffix.lower() in _YAML) and there.absolute() not in self._seen:
                self._seen.add(there.absolute())
                self._look_into(_read(there), there)

    def _check_text(self, name: str, value: str, path: Path, allowed: Callable[[str], bool]) -> None:
        """Refuse a text that names a class or a function, be it written out in YAML, unless it is allowed."""
        names_class = name == "class_path" or (name in self.classes and re.fullmatch(r"\w+", value))
        if (names_class or _can_be_imported(value)) and not allowed(value):
            raise InputError(
                f"the configuration {path} names {ascii(value)[:80]} as {name}, which --safe-config does not "
                "allow: it takes registered classes and a few of torch's and Lightning's."
            )
        if _STRUCTURE.search(value):
            try:
                inner = None if yaml_limit_error(value) else load_yaml(value)
            except yaml.YAMLError:
                return
            if inner != value:
                self._look_into({name: inner}, path)


def load_bounded(text: str, load: Callable[[str], Any]) -> Any:
    """Return what a text in YAML says, wherever the parser meets one: in a file, or as an argument.

    Args:
        text: what to load.
        load: the parser's own way of loading, which knows its numbers.

    Raises:
        InputError: if it stands for too much.
    """
    # Most are a word or a number; less than a line without an anchor cannot stand for much.
    if "&" in text or len(text) > 100:
        if len(text) > MOST_SETTINGS:
            raise InputError(f"a setting has more than {MOST_SETTINGS} bytes; no settings need as many.")
        if excess := yaml_limit_error(text):
            raise InputError(f"a setting {excess}; settings need no such thing.")
    return load(text)


def _read(path: Path) -> Any:
    """Return what a file says."""
    try:
        text = read_bounded(path, MOST_SETTINGS).decode("utf-8")
        if excess := yaml_limit_error(text):
            raise InputError(f"the configuration {path} {excess}; settings need no such thing.")
        return load_yaml(text)
    except FileNotFoundError:
        names, given = shipped_names(), path.with_suffix("")
        hint = did_you_mean(str(given), names) or did_you_mean(given.name, names)
        hint = hint or f" Those of the package, such as paper and quickstart, are in {shipped_folder()}."
        raise InputError(f"there is no configuration file {path}.{hint}") from None
    except OSError as error:
        raise InputError(f"the configuration {path} cannot be read: {error.strerror}.") from None
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise InputError(f"the configuration {path} is not YAML: {line}{error.problem}.") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise InputError(f"the configuration {path} is not a text in YAML.") from None


def _values(content: Any, key: str) -> Iterator[tuple[str, Any]]:
    """Yield every value in settings, groups and lists included, with the key that it has."""
    yield key, content
    if isinstance(content, dict):
        for name, value in content.items():
            yield from _values(value, str(name))
    elif isinstance(content, list):
        for value in content:
            yield from _values(value, key)


def _can_be_imported(text: str) -> bool:
    """Return whether a text may name something in a module; a file called a.json lies in no module a."""
    if not _DOTTED.fullmatch(text):
        return False
    try:
        return importlib.util.find_spec(text.partition(".")[0]) is not None
    except (ImportError, ValueError):
        return True
