"""Parser errors: rewrite the parser's long messages as a single sentence."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from normalgan.errors import brief, did_you_mean
from normalgan.registry import Registry
from normalgan.weights.local_classes import where_classes_are_looked_for

_KINDS = {
    "int": "a whole number",
    "float": "a number",
    "str": "text",
    "bool": "true or false",
    "NoneType": "null",
    "list": "a list",
    "tuple": "a list",
    "Iterable": "a list",
    "dict": "a mapping",
}
"""Plain words for Python types."""
_OF_A_CLASS = ("class_path", "init_args")
_LONGEST_LIST = 16
"""Longer lists of names are left out of the message about an unknown name."""


def explain(
    message: str,
    plugins: Mapping[str, Registry[Any]],
    settings: Sequence[str] = (),
    options: Mapping[str, str] | None = None,
    choices: Mapping[str, str] | None = None,
) -> str:
    r"""Return a jsonargparse error message as one sentence, with a suggestion.

    Args:
        message: the message, whose lines go deeper and deeper into the types that were tried.
        plugins: classes that can be named, by the last part of the setting that names them.
        settings: dotted names of all settings.
        options: command-line spelling of each setting, for commands without configurations; None uses dotted
            names.
        choices: accepted values of options that only take certain values, as shown by ``--help``.

    >>> explain('Parser key "data.size":\n  Expected a <class \'int\'>. Got value: large', {})
    'argument "data.size": expected a whole number, not large.'
    >>> explain('Parser key "report.metrics":\n  Expected a <class \'list\'>. Got value: ShareBelow', {})
    'argument "report.metrics": expected a list, not ShareBelow. A list of one is \'[ShareBelow]\'.'
    >>> explain('Parser key "size":\n  Not of type Side: 4 does not conform to restriction v>=8 and v<=9', {})
    'argument "size": 4 is out of range; it must be >= 8 and <= 9.'
    >>> explain('Parser key "data.split": Unable to load config "x.yaml"', {}, ["data.split.file"])
    'data.split is a group of settings, such as data.split.file, and x.yaml is not a file of them.'
    >>> explain("Group 'data' does not accept option 'sise'", {}, ["data.size"])
    'there is no setting data.sise. Did you mean data.size?'
    >>> explain("unrecognized arguments: --height_scale 3", {}, (), {"height_scale": "--height-scale"})
    'there is no option --height_scale. Did you mean --height-scale?'
    >>> explain("argument --size: expected one argument", {})
    '--size needs a value.'
    >>> explain("argument --height: expected one argument", {}, choices={"--height": "{png,exr}"})
    '--height needs a value: png or exr.'
    """
    steps = re.findall(r'Parser key "([^"]+)"(?: element (\d+))?:', message)
    key = ".".join(name for name, _ in steps)
    if sentence := _bad_name(message, settings, options):
        return sentence
    sentence = (
        _bad_value(message)
        or _bad_class(message, plugins.get(key.rpartition(".")[2]))
        or _misused(message, options or {}, choices or {})
        or (_wrong_type(message, null=not options) if key else "")
    )
    if not sentence:  # none of the messages known here
        return " ".join(message.replace(" - ", " ").split())
    item = "".join(f", item {number}" for _, number in steps if number)
    return f"{_spelled(key, options)}{item}: {sentence}" if key else sentence


def refusal(error: Exception) -> str:
    r"""Return a class's own error message about its settings as one sentence.

    jsonargparse buries it in a list of reasons why all other types of the setting did not fit.

    >>> tried = "Does not validate against any of the Union subtypes\n  - size is 0.\n  - Expected a None"
    >>> refusal(ValueError(tried))
    'size is 0.'
    >>> refusal(TypeError("width is missing\nlong story"))
    'width is missing'
    >>> refusal(ValueError("Problem with given class_path 'some.Logger':\n  some is not installed"))
    'Logger: some is not installed'
    """
    if found := re.search(
        r"^ *(?:- )?Problem with given class_path '(.+?)':\s+(.+)$", str(error), re.MULTILINE
    ):
        return f"{found[1].rpartition('.')[2]}: {found[2]}"
    if "Union subtypes" not in str(error):
        return brief(error)
    reasons = re.findall(r"^ *- (.+)$", str(error), re.MULTILINE)
    own = [reason for reason in reasons if not reason.startswith(("Expected", "Does not validate"))]
    return own[0] if own else brief(error)


def _spelled(key: str, options: Mapping[str, str] | None) -> str:
    """Return the name of a setting in error messages: its command-line option, if it has one."""
    head, dot, rest = key.partition(".")
    option = (options or {}).get(head)
    return f"{option}{dot}{rest}" if option else f'argument "{key}"'


def _bad_name(message: str, settings: Sequence[str], options: Mapping[str, str] | None) -> str:
    """Return the explanation of an unknown name, or of a value for a group; empty for other errors."""
    if found := re.search(r'Parser key "([^"]+)": Unable to load config "([^"]*)"$', message):
        inside = next((f", such as {name}," for name in settings if name.startswith(f"{found[1]}.")), "")
        return f"{found[1]} is a group of settings{inside} and {found[2]} is not a file of them."
    kinds = r"(?:Group '(.+)' does not accept option|Option|unrecognized arguments:)"
    found = re.match(kinds + r" '?(?:--)?([^\s'=]+)", message)
    if found is None:
        return ""
    rest = message.removeprefix("unrecognized arguments: ")
    given = rest.split()[0]
    if options and not given.startswith("-"):
        return f"unexpected argument {rest}."  # names may have spaces, and argparse joins all with spaces
    if options:
        name = given.partition("=")[0]
        return f"there is no option {name}.{did_you_mean(name, options.values())}"
    name = ".".join(part for part in found.groups() if part)
    if re.match("unrecognized arguments: [^-]", message):
        return f"{name!r} is not an option; write --config FILE, --ckpt_path FILE or --SETTING VALUE."
    return f"there is no setting {name}.{did_you_mean(name, settings)}"


def _bad_value(message: str) -> str:
    """Return the explanation of a value that is not allowed or out of range; empty for other errors."""
    if found := re.search(r"Importing '(.+?)' is not allowed", message):
        return (
            f"--safe-config does not allow {found[1]}; it only allows registered classes and "
            "some of torch and Lightning."
        )
    if found := re.search(r"Not of type \w+: (.*)does not conform to restriction (.+)", message):
        value = found[1].strip() or _given(message)
        bounds = re.sub(r"v([<>]=?)", r"\1 ", found[2])
        return f"{value} is out of range; it must be {bounds}."
    if found := re.search(r"Not of type \w+: .*: '?([^'\n]*)", message):
        whole = "whole " if "literal for int()" in found[0] else ""
        return f"expected a {whole}number, not {found[1]}."
    if found := re.search(r"Option '(.+?)' is not accepted(.*)", message):
        return f"there is no setting {found[1]!r} in it.{found[2] or did_you_mean(found[1], _OF_A_CLASS)}"
    return ""


def _misused(message: str, options: Mapping[str, str], choices: Mapping[str, str]) -> str:
    """Return the explanation of an argparse error about arguments and their values; empty for others."""
    if found := re.search(r"the following arguments are required: (.+)", message):
        return f"missing: {', '.join(options.get(each, each) for each in found[1].split(', '))}."
    if found := re.fullmatch(r"ambiguous option: (\S+) could match (.+), (\S+)", message):
        return f"{found[1]} may be {found[2]} or {found[3]}; write the option in full."
    if found := re.fullmatch(r"argument (?:\S+/)?(-[^:]+): ignored explicit argument '(.*)'", message):
        return f"{found[1]} takes no value, not {found[2]}."
    if found := re.fullmatch(r"argument (?:\S+/)?(.+): invalid choice: '(.*)' \(choose from (.+)\)", message):
        return f"{found[1]}: expected one of {found[3]}, not {found[2]}."
    if found := re.fullmatch(r"argument (?:\S+/)?(-[^:]+): expected .*arguments?", message):
        values = choices.get(found[1], "").strip("{}").replace(",", " or ")
        return f"{found[1]} needs a value{values and f': {values}'}."
    return ""


def _bad_class(message: str, registry: Registry[Any] | None) -> str:
    """Return the explanation of an error about a named class; empty for other errors."""
    if found := re.search(
        r"Multiple subclasses with name (\w+)\. .* ambiguity: (.+)\.$", message, re.MULTILINE
    ):
        return f"several classes are named {found[1]}; give the full name: {found[2].replace(', ', ' or ')}."
    if found := re.search(r"but (\S+) is abstract", message):
        return f"{found[1]} is abstract; name a class that defines all of its methods."
    if found := re.search(r"Import path (\S+) does not correspond to a subclass of (\w+)", message):
        return f"{found[1]} is not a {found[2]}{_known(registry)}."
    if found := re.search(r"Expected a dot import path string: (.+)", message):
        return _unknown(registry, found[1]) if registry else f"no class named {found[1]!r}."
    if found := re.search(r"Problem with given class_path '(.+?)':\s+(?!\s|Parser key)(.+)", message):
        if sentence := _bad_class_settings(found[1], found[2]):
            return sentence
        advice = f": {_unknown(registry, found[1].rpartition('.')[2])}" if registry else "."
        missing = found[2].startswith(f"No module named '{found[1].partition('.')[0]}")
        elsewhere = where_classes_are_looked_for(found[1]) if missing else ""
        return f"{found[1]} cannot be imported ({found[2]}){advice}{elsewhere}"
    if found := re.search(r"Not a valid subclass of (\w+)", message):
        return f"{_given(message)} is not a {found[1]}{_known(registry)}."
    return ""


def _bad_class_settings(path: str, problem: str) -> str:
    """Return the explanation of an error about the settings of a class; empty if the class was not found."""
    if found := re.match(r"Group '(.+)' does not accept option '(.+)'", problem):
        return f"{found[1]}.{found[2]} is not a setting of it; write class_path and init_args."
    if found := re.match(r"the following arguments are required: ([^)]+)", problem):
        return f"{path} needs its settings {found[1]}; give them in init_args."
    return ""


def _known(registry: Registry[Any] | None) -> str:
    return f"; known: {', '.join(registry.names())}" if registry else ""


def _unknown(registry: Registry[Any], name: str) -> str:
    if len(registry.names()) <= _LONGEST_LIST:
        return registry.explain_unknown(name)
    return f"no {registry.base.__name__} named {name!r}.{did_you_mean(name, registry.names())}"


def _wrong_type(message: str, null: bool) -> str:
    """Return the explanation of a value of a wrong type; empty for other errors.

    Args:
        message: jsonargparse's message.
        null: whether to name null, which cannot be written as an option, among the accepted values.
    """
    texts = re.findall(r"Expected an? (.+?)(?:\. Got value.*)?$", message, re.MULTILINE)
    wanted = dict.fromkeys(
        _plain(text) for text in texts if not text.startswith(("path but", "dot import path"))
    )
    if not null:
        wanted.pop("null", None)
    if not wanted:
        return ""
    given = _given(message)
    single = "a list" in wanted and re.fullmatch(r"[\w.]+", given)
    advice = f" A list of one is '[{given}]'." if single else ""
    return f"expected {' or '.join(wanted)}, not {given}.{advice}"


def _plain(text: str) -> str:
    """Return an accepted value in plain words, from `_KINDS` where possible."""
    if named := re.fullmatch(r"<class '(?:\w+\.)*(\w+)'>", text):
        return _KINDS.get(named[1], f"a {named[1]}")
    if literal := re.fullmatch(r"typing\.Literal\[(.+)\]", text):
        return f"{'one of ' if ', ' in literal[1] else ''}{literal[1]}"
    return f"a {text}"


def _given(message: str) -> str:
    given = str(re.findall(r"G(?:ot|iven) value: (.*)", message)[-1])
    # jsonargparse's representation of the value of a dotted option.
    nested = re.fullmatch(r"NestedArg\(key='.*', val='(.*)'\)", given)
    return nested[1] if nested else given
