"""Broken plug-ins: for each fault a class that is right but for one method."""

from collections.abc import Callable, Mapping
from typing import Any

Fault = tuple[Callable[..., Any], str]
"""The wrong method, called with the right one and its arguments; and the sentence after the class name."""


def broken(
    right: type[Any], method: str, module: dict[str, Any], faults: Mapping[str, Fault]
) -> list[tuple[type[Any], str]]:
    """Return a class for each fault, by its name, and the sentence of the kit.

    Args:
        right: a plug-in without a fault.
        method: the one that is replaced.
        module: its globals, where the classes go: the kit asks whether they can be imported.
        faults: by the name of the class.
    """
    made = []
    for name, (wrong, sentence) in faults.items():
        body = {
            "__doc__": f"Has a fault in {method}.",
            "__module__": module["__name__"],
            method: _replaced(right, method, wrong),
        }
        module[name] = type(name, (right,), body)
        made.append((module[name], f"{name}{'' if sentence.startswith('.') else ' '}{sentence}"))
    return made


def _replaced(right: type[Any], method: str, wrong: Callable[..., Any]) -> Callable[..., Any]:
    def call(self: Any, *given: Any) -> Any:
        return wrong(getattr(right, method).__get__(self), *given)

    return call
