"""Ranges: annotations for the numbers or words that a setting accepts, checked in the constructor."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from normalgan.errors import InputError


class OutOfRangeError(InputError):
    """Error for a setting outside its range.

    Args:
        message: the full sentence, with the setting and its class.
        setting: the setting's name.
        verdict: the part of the sentence after the setting's name, for callers that use another name for
            it.
    """

    def __init__(self, message: str, setting: str = "", verdict: str = "") -> None:
        super().__init__(message)
        self.setting, self.verdict = setting, verdict


@dataclass(frozen=True)
class Range:
    """The range of finite numbers that a setting accepts.

    Args:
        least: minimum.
        most: maximum.
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

    def __contains__(self, value: object) -> bool:
        """Return whether a value is in the range; False for nan and for other types."""
        if not isinstance(value, Real):
            return False
        try:
            number = float(value)
        except OverflowError:  # an integer of hundreds of digits
            return False
        low = self.least < number if self.above else self.least <= number
        return low and (number < self.most if self.below or self.most == math.inf else number <= self.most)

    def __repr__(self) -> str:
        """Return the range in words; ``--help`` shows it as part of the type."""
        if self.most == math.inf:
            return f"more than {self.least:g}" if self.above else f"{self.least:g} or more"
        first = f"above {self.least:g}, up" if self.above else f"from {self.least:g}"
        return f"{first} to {'below ' if self.below else ''}{self.most:g}"

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Let pydantic check the range; a string is not converted to a number."""
        from pydantic_core.core_schema import no_info_after_validator_function

        schema = handler(source)
        if schema["type"] in {"float", "int"}:
            schema = {**schema, "strict": True}
        return no_info_after_validator_function(self._checked, schema)

    def _checked(self, value: Any) -> Any:
        from pydantic_core import PydanticCustomError

        if wrong := _wrong(value, self):
            raise PydanticCustomError("range", "Input should be {right}", {"right": wrong})
        return value


class OneOf:
    """The words that a setting accepts, where a `Literal` cannot list them.

    Args:
        values: accepted words.
    """

    def __init__(self, values: Iterable[Any]) -> None:
        self._values = tuple(values)

    def __contains__(self, value: object) -> bool:
        """Return whether a value is one of the words."""
        return any(value == each and type(value) is type(each) for each in self._values)

    def __repr__(self) -> str:
        """Return the words."""
        *first, last = map(repr, self._values)
        return f"{', '.join(first)} or {last}" if first else last

    def __get_pydantic_core_schema__(self, source: Any, handler: object) -> Any:
        """Let pydantic check the word."""
        from pydantic_core.core_schema import literal_schema

        return literal_schema(list(self._values))


Count = Annotated[int, Range(0)]
PositiveInt = Annotated[int, Range(1)]
NonNegative = Annotated[float, Range(0)]
Positive = Annotated[float, Range(0, above=True)]
UnitInterval = Annotated[float, Range(0, 1)]
"""A fraction or a probability."""


class RangeChecked:
    """Base class of plug-in kinds: the constructors of their dataclasses check the ranges of the settings.

    A subclass with a ``__post_init__`` of its own calls this one first. Groups of settings call
    `check_ranges` themselves, because jsonargparse takes a dataclass with such a base for one of several
    classes to choose from.

    Example:
        >>> @dataclass
        ... class Blur(RangeChecked):
        ...     radius: Positive = 1.0
        >>> Blur(radius=0)
        Traceback (most recent call last):
        normalgan.ranges.OutOfRangeError: radius of Blur is 0; it must be more than 0.
    """

    def __post_init__(self) -> None:
        check_ranges(self)


def check_ranges(settings: Any, values: Mapping[str, Any] | None = None) -> None:
    """Check all settings of an object that its constructor annotates with a `Range` or a `Literal`.

    Plug-ins that are dataclasses have this from `RangeChecked`; other classes call it in their constructor.
    If the annotation is on a tuple, the tuple must hold two numbers, low then high.

    Args:
        settings: the object.
        values: the settings by name; by default the object's attributes.

    Raises:
        OutOfRangeError: if a setting is outside its range or not one of the accepted words.
    """
    kind: Any = type(settings)  # mypy does not consider a type hashable
    for name, hint in _hints(kind).items():
        value = getattr(settings, name) if values is None else values[name]
        for given, allowed in _given(hint, value):
            if wrong := _wrong(given, allowed):
                subject = "it" if given is value else "each"
                shown = repr(value) if isinstance(value, str) else value
                verdict = f"is {shown}; {subject} must be {wrong}."
                raise OutOfRangeError(f"{name} of {kind.__name__} {verdict}", name, verdict)


@cache
def _hints(kind: Any) -> dict[str, Any]:
    found = get_type_hints(kind.__init__, include_extras=True)
    return {name: hint for name, hint in found.items() if _ranged(hint)}


def _ranged(hint: Any) -> bool:
    return get_origin(hint) in (Annotated, Literal) or any(map(_ranged, get_args(hint)))


def _wrong(given: Any, allowed: Range | OneOf) -> str:
    """Describe the accepted values if a number, pair or word is not one of them; otherwise return ""."""
    pair = isinstance(given, list | tuple)
    numbers: Sequence[Any] = given if pair else [given]
    rising = not pair or (len(numbers) == 2 and numbers[0] <= numbers[1])
    if rising and all(number in allowed for number in numbers):
        return ""
    return f"{'two numbers, low then high, ' if pair else ''}{allowed}"


def _given(hint: Any, value: Any) -> list[tuple[Any, Range | OneOf]]:
    """Return each restricted part of a setting's value together with its range."""
    if value is None:
        return []
    if get_origin(hint) is Annotated:
        return [(value, each) for each in hint.__metadata__ if isinstance(each, Range)]
    if get_origin(hint) is Literal:
        return [(value, OneOf(get_args(hint)))]
    inner = [each for each in get_args(hint) if each not in (type(None), ...)]
    if isinstance(value, Mapping):
        return [pair for item in value.values() for pair in _given(inner[-1], item)]
    if isinstance(value, list | tuple) and get_origin(hint) in (list, tuple):
        return [pair for item in value for pair in _given(inner[0], item)]
    # A union: the value is one of the words of its literals, or belongs to one of its other types.
    words = [word for each in inner if get_origin(each) is Literal for word in get_args(each)]
    others = [each for each in inner if get_origin(each) is not Literal]
    if words and (not others or value in OneOf(words)):
        return [(value, OneOf(words))]
    return [pair for each in others for pair in _given(each, value)]
