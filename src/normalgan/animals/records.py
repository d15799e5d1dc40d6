"""Records: the types of what species files hold, which pydantic reads."""

import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from normalgan.arrays import Doubles
from normalgan.errors import InputError, brief, did_you_mean
from normalgan.files.limits import read_named
from normalgan.ranges import Range

__all__ = ["FOLDER", "SHARED", "Bone", "Column", "Kinds", "Number", "Point", "Record", "Span", "read_toml"]

FOLDER = Path(__file__).with_name("species")
"""The species files of the package."""
SHARED = FOLDER / "shared.toml"
"""Tables that several of them use, by class and name."""

_GREATEST = 10_000
"""Sizes are about 1, angles in degrees: numbers that are greater would only overflow."""
Number = Annotated[float, Range(-_GREATEST, _GREATEST)]
Span = Annotated[tuple[Number, Number], Range(-_GREATEST, _GREATEST)]
"""The least and the greatest of what is drawn evenly."""
Point = tuple[Number, Number, Number]
Bone = Annotated[float, Range(0.01, 100)]
"""The length of a bone: one of no length has no direction in which to grow."""


class Record:
    """The base of dataclasses that are read from a table, or from the name of a table in `SHARED`."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Look names up, and refuse unknown fields."""
        schema = handler(source)
        # By its ref, pydantic uses a schema again where a class appears again: this one, not the one within.
        within = {key: value for key, value in schema.items() if key != "ref"}
        return _reader(cls, within, schema.get("ref"))


class Kinds:
    """In an annotation, what makes an object of each kind that a table may name as its ``kind``.

    Args:
        makers: dataclasses or functions, by kind; a table without a kind is of the first.
    """

    def __init__(self, **makers: Callable[..., Any]) -> None:
        self._makers = makers

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Let the kind decide."""
        from pydantic_core.core_schema import tagged_union_schema

        first, *_ = self._makers
        return tagged_union_schema(
            {kind: _reader(make, handler.generate_schema(make)) for kind, make in self._makers.items()},
            discriminator=lambda table: table.get("kind", first) if isinstance(table, dict) else first,
            custom_error_type="kind",
            custom_error_message=f"The table should have as its kind one of {', '.join(self._makers)}",
        )


class _Listed:
    """In an annotation, reads an array from a list."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        from pydantic_core.core_schema import no_info_after_validator_function

        return no_info_after_validator_function(_column, handler.generate_schema(tuple[Number, ...]))


Column = Annotated[Doubles, _Listed()]
"""(n,) numbers that individuals share, so that they cannot be written to."""


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a species file.

    Raises:
        InputError: if it cannot be read or is not TOML.
    """
    content = read_named(path)
    try:
        return tomllib.loads(content.decode("utf-8"))
    except ValueError as error:  # tomllib's, or of bytes that are not UTF-8
        raise InputError(f"{path} is not a species file, which is TOML: {brief(error)}.") from error


def _reader(make: Callable[..., Any], schema: Any, ref: str | None = None) -> Any:
    from pydantic_core.core_schema import no_info_wrap_validator_function

    # It wraps, so that pydantic names the field where ``make`` itself refuses its arguments.
    return no_info_wrap_validator_function(lambda given, read: read(_table(make, given)), schema, ref=ref)


def _table(make: Callable[..., Any], given: Any) -> Any:
    shared = _shared().get(getattr(make, "__name__", ""), {})
    if isinstance(given, str) and shared:
        if given not in shared:
            known = ", ".join(sorted(shared))
            raise InputError(f"there is no {given!r}.{did_you_mean(given, shared)} Known: {known}.")
        given = shared[given]
    if not isinstance(given, Mapping):
        return given
    fields = signature(make).parameters
    table = {name: value for name, value in given.items() if name != "kind"}
    for name in (each for each in table if each not in fields):
        raise InputError(f"{name} is not known.{did_you_mean(name, fields)} Known: {', '.join(fields)}.")
    return table


@cache
def _shared() -> dict[str, Any]:
    return read_toml(SHARED)


def _column(numbers: tuple[float, ...]) -> Doubles:
    column = np.array(numbers, dtype=np.float64)
    column.flags.writeable = False
    return column
