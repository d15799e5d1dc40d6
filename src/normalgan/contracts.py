"""Errors for plug-ins that return invalid values, raised right where the value is returned."""

from collections.abc import Collection, Mapping

from torch import Tensor

from normalgan.errors import InputError


def check_kinds(given: Mapping[str, tuple[object, type]], optional: Collection[str] = ()) -> None:
    """Check the types of settings that a caller from Python passed.

    Args:
        given: value and required type of each setting, by its name.
        optional: names of the settings that may be None.

    Raises:
        InputError: if a value is not an instance of its type; it may be a name, or the class itself.
    """
    for setting, (value, kind) in given.items():
        if not (isinstance(value, kind) or (value is None and setting in optional)):
            raise _wrong_kind(setting, value, kind)


def _wrong_kind(setting: str, value: object, kind: type) -> InputError:
    given = repr(value) if isinstance(value, str) else describe(value)
    if isinstance(value, type):
        given = f"the class {value.__name__}"
        given += f"; write {value.__name__}(…)" if issubclass(value, kind) else ""
    return InputError(f"{setting} must be an object of a class of {kind.__name__}, not {given}.")


def class_name(plugin: object) -> str:
    """Return the name of a plug-in's class."""
    return type(plugin).__name__


def refused(plugin: object, gave: object, asked: str) -> InputError:
    """Return the error for an invalid output of a plug-in.

    Args:
        plugin: the plug-in.
        gave: its output.
        asked: the accepted values, as a sentence without a full stop.
    """
    return InputError(f"{class_name(plugin)} gave {describe(gave)}; {asked}.")


def describe(value: object) -> str:
    """Describe a value in a few words: a tensor by its shape, anything else by its type.

    >>> import torch
    >>> describe(torch.zeros(2, 1)), describe((torch.zeros(2), 3)), describe(None)
    ('a tensor (2, 1)', 'a tuple of (a tensor (2,), an int)', 'None')
    """
    match value:
        case None:
            return "None"
        case Tensor():
            return f"a tensor {tuple(value.shape)}"
        case tuple() | list() if value:
            return f"a {type(value).__name__} of ({', '.join(describe(each) for each in value[:3])})"
        case tuple() | list() | dict() if not value:
            return f"an empty {type(value).__name__}"
        case _:
            name = type(value).__name__
            return f"a{'n' * (name[0].lower() in 'aeiou')} {name}"
