"""Ranges: what numbers a setting takes, said in its annotation and checked in its class's constructor."""

import math
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from normalgan.errors import InputError

__all__ = ["Count", "NonNegative", "Positive", "PositiveInt", "Range", "Share", "check_ranges"]


@dataclass(frozen=True)
class Range:
    """The numbers that a setting takes; none of them is infinite.

    Args:
        least: the smallest.
        most: the largest.
        above: whether ``least`` itself is excluded.
        below: whether ``most`` itself is excluded.

    Example:
        >>> 90 in Range(0, 90, below=True), 89.5 in Range(0, 90, below=True)
        (False, True)
        >>> print(Range(0), Range(0, 1), Range(0, 90, below=True), sep="; ")
        0 or more; from 0 to 1; from 0 to below 90
    """

    least: float
    most: float = math.inf
    above: bool = False
    below: bool = False

    def __contains__(self, value: float) -> bool:
        """Return whether a setting may have a value; not a number never may."""
        low = self.least < value if self.above else self.least <= value
        return low and (value < self.most if self.below or self.most == math.inf else value <= self.most)

    def __repr__(self) -> str:
        """Return the range in words, which `--help` shows as a part of the type."""
        if self.most == math.inf:
            return f"more than {self.least:g}" if self.above else f"{self.least:g} or more"
        first = f"above {self.least:g}" if self.above else f"from {self.least:g}"
        return f"{first} to {'below ' if self.below else ''}{self.most:g}"


Count = Annotated[int, Range(0)]
PositiveInt = Annotated[int, Range(1)]
NonNegative = Annotated[float, Range(0)]
Positive = Annotated[float, Range(0, above=True)]
Share = Annotated[float, Range(0, 1)]


def check_ranges(settings: object) -> None:
    """Check all settings of an object that its constructor annotates with a `Range`.

    The last line of ``__init__``, where every such setting is an attribute of its parameter's name. A
    dataclass says ``__post_init__ = check_ranges``.

    Raises:
        InputError: if one lies outside its range.

    Example:
        >>> @dataclass
        ... class Blur:
        ...     radius: Positive = 1.0
        ...     __post_init__ = check_ranges
        >>> Blur(radius=0)
        Traceback (most recent call last):
        normalgan.errors.InputError: radius of Blur is 0; it must be more than 0.
    """
    for name, hint in _hints(type(settings)).items():
        value = getattr(settings, name)
        for number, allowed in _numbers(hint, value):
            if number not in allowed:
                each = "it" if number is value else "each number"
                raise InputError(f"{name} of {type(settings).__name__} is {value}; {each} must be {allowed}.")


@cache
def _hints(kind: type) -> dict[str, Any]:
    found = get_type_hints(kind.__init__, include_extras=True)  # type: ignore[misc]
    return {name: hint for name, hint in found.items() if _ranged(hint)}


def _ranged(hint: Any) -> bool:
    return get_origin(hint) is Annotated or any(map(_ranged, get_args(hint)))


def _numbers(hint: Any, value: Any) -> list[tuple[float, Range]]:
    """Return the numbers in a value, each with its range: one, those of a list or tuple, or none."""
    if value is None:
        return []
    if get_origin(hint) is Annotated:
        return [(value, each) for each in hint.__metadata__ if isinstance(each, Range)]
    inner = [each for each in get_args(hint) if each not in (type(None), ...)]
    if isinstance(value, list | tuple) and get_origin(hint) in (list, tuple):
        return [pair for item in value for pair in _numbers(inner[0], item)]
    return [pair for each in inner for pair in _numbers(each, value)]
