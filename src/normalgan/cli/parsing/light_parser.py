"""LightParser: the parser of commands without Lightning, and the base class of all parsers."""

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import UnionType
from typing import Any, Literal, NoReturn, Union, get_args, get_origin

from jsonargparse import ActionConfigFile, ArgumentParser, Namespace  # type: ignore[attr-defined]  # so does Lightning

from normalgan.cli.parsing.errors import explain
from normalgan.errors import CommandExit, InputError, did_you_mean
from normalgan.files.limits import load_yaml
from normalgan.registry import Registry


class OwnDefaultsParser(ArgumentParser):
    """A parser that reports errors in one sentence, with suggestions for typos.

    It does not carry the settings of a class over to a class that replaces it.
    When another class is named, jsonargparse keeps every setting that both classes have, even if it was only
    a default of the first class (https://github.com/mauvilsa/jsonargparse/issues/460). A brush, for example,
    got the default line width of another style. Settings from options are kept if an option names the class.
    """

    def add_argument(self, *names: Any, **how: Any) -> Any:
        """Add an argument; configuration files are read by `_Overlay`."""
        if how.get("action") in ("config", ActionConfigFile):
            how["action"] = _Overlay
        return super().add_argument(*names, **how)

    def error(self, message: str, ex: Exception | None = None) -> NoReturn:
        """Raise `InputError` instead of printing a usage page."""
        settings = [action.dest for action in self._actions]
        if self.exit_on_error:
            sentence = explain(message, self._plugins(), settings, self._options(), self._choices())
            raise InputError(sentence) from ex
        # Part of a longer message about a class, which the parser of the whole command explains.
        unknown = re.fullmatch(r"Option '(.+)' is not accepted", message)
        super().error(message + (did_you_mean(unknown[1], settings) if unknown else ""), ex)

    def _plugins(self) -> Mapping[str, Registry[Any]]:
        """Return the registries of the settings that name plug-ins."""
        return {}

    def _options(self) -> Mapping[str, str]:
        """Return the option of each setting, in commands without configurations."""
        return {}

    def _choices(self) -> dict[str, str]:
        """Return the accepted values of options that only take certain values, as shown by ``--help``."""
        return {
            name: action.metavar
            for action in self._actions
            for name in action.option_strings
            if isinstance(action.metavar, str) and action.metavar.startswith("{")
        }

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """Raise `CommandExit`, which cannot be confused with a plug-in's ``sys.exit``."""
        if message:
            print(message, file=sys.stderr, end="")
        raise CommandExit(status)

    def get_defaults(self, *given: Any, **how: Any) -> Namespace:
        """Return all defaults; default classes only have explicit arguments, as parsing adds the rest."""
        defaults = super().get_defaults(*given, **how)
        for key, value in list(defaults.items(branches=True)):
            if isinstance(value, Namespace) and "class_path" in value and "init_args" in value:
                try:
                    chosen = self.get_default(key)
                except KeyError:  # a nested class
                    continue
                set_here = chosen.get("init_args", {}) if isinstance(chosen, dict | Namespace) else {}
                for name in set(vars(value.init_args)) - set(dict(set_here.items())):
                    del value.init_args[name]
        return defaults


class LightParser(OwnDefaultsParser):
    """The parser of a command without configurations."""

    plugins: Mapping[str, Registry[Any]] = {}
    """Registries of the settings that name plug-ins."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        # jsonargparse's own formatter would add the Python type of each option.
        super().__init__(*args, formatter_class=argparse.HelpFormatter, **settings)

    def parse_args(self, args: Sequence[str] | None = None, *given: Any, **how: Any) -> Any:  # type: ignore[override]  # argparse overloads it
        """Return the settings of a command line, whose file names may start with a dash."""
        options = [option for action in self._actions for option in action.option_strings]
        words = _as_shell_means(sys.argv[1:] if args is None else args, options)
        return super().parse_args(words, *given, **how)

    def _plugins(self) -> Mapping[str, Registry[Any]]:
        return self.plugins

    def _options(self) -> Mapping[str, str]:
        """Return the long option of each setting that has one."""
        long = {
            action.dest: [name for name in action.option_strings if name.startswith("--")]
            for action in self._actions
        }
        return {setting: names[0] for setting, names in long.items() if names}


def _as_shell_means(arguments: Sequence[str], options: Sequence[str]) -> list[str]:
    """Return arguments changed so that file names that start with a dash are not parsed as options.

    Everything after ``--`` is a file name. Before it, an argument that names an existing file and is not an
    option is a file name.

    Args:
        arguments: arguments from the shell.
        options: options that the parser knows.
    """
    out: list[str] = []
    for i, each in enumerate(arguments):
        if each == "--":
            return out + [
                f"./{one}" if one.startswith("-") and one != "-" else one for one in arguments[i + 1 :]
            ]
        file = each.startswith("-") and each != "-" and each not in options and Path(each).is_file()
        out.append(f"./{each}" if file else each)
    return out


def refuse_empty(settings: Namespace, *options: str) -> None:
    """Raise `InputError` if an option for a file is empty, because it would stand for the current folder."""
    for option in options:
        if settings[option] == "":
            raise InputError(f"--{option} is empty; name a file or a folder, such as '.'.")


def choices(kind: Any) -> str | None:
    """Return the choices of an option for ``--help``; None if the option also takes other values.

    >>> choices(Literal["png", "exr"] | None), choices(Literal["batch"] | float)
    ('{png,exr}', None)
    """
    kinds = get_args(kind) if get_origin(kind) in {Union, UnionType} else (kind,)
    named = [each for each in kinds if each is not type(None)]
    if not named or any(get_origin(each) is not Literal for each in named):
        return None
    return f"{{{','.join(str(word) for each in named for word in get_args(each))}}}"


class _Overlay(ActionConfigFile):
    """An action that drops the settings of classes that a file replaces, and then reads the file."""

    def __call__(self, parser: Any, settings: Any, file: Any, option: Any = None) -> None:
        if Path(file).is_file():
            _drop_replaced(settings, load_yaml(Path(file).read_text(encoding="utf-8")))
        super().__call__(parser, settings, file, option)  # type: ignore[no-untyped-call]


def _drop_replaced(settings: Any, named: object) -> None:
    """Drop the settings of replaced classes at any depth."""
    if not (isinstance(settings, Namespace) and isinstance(named, Mapping)):
        return
    another = "class_path" in named and _class_name(named) != _class_name(settings)
    if another and "init_args" in settings:
        settings["init_args"] = Namespace()  # type: ignore[no-untyped-call]
    for key, value in named.items():
        if key in settings:
            _drop_replaced(settings[key], value)


def _class_name(spec: Any) -> str:
    """Return the short name of a class, because a class may be exported from several modules."""
    return str(spec.get("class_path")).rpartition(".")[2]
