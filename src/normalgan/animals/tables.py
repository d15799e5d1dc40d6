"""Tables: the types of the contents of species files."""

import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from normalgan.arrays import Doubles
from normalgan.errors import InputError, brief, did_you_mean
from normalgan.files.limits import read_named
from normalgan.ranges import Range
from normalgan.records import Record, reads

FOLDER = Path(__file__).with_name("species")
"""The species files of the package."""
SHARED = FOLDER / "shared.toml"
"""Tables shared by several species files, by class and name."""

_LARGEST_NUMBER = 10_000
"""Bound of numbers; sizes are about 1 and angles are in degrees, so larger numbers would only overflow."""
Number = Annotated[float, Range(-_LARGEST_NUMBER, _LARGEST_NUMBER)]
Span = Annotated[tuple[Number, Number], Range(-_LARGEST_NUMBER, _LARGEST_NUMBER)]
"""Minimum and maximum of a uniform distribution."""
Point = tuple[Number, Number, Number]
Bone = Annotated[float, Range(0.01, 100)]
"""The length of a bone, positive because a bone of length 0 has no direction."""


class Table(Record):
    """Base class of dataclasses that are read from a table, or from the name of a table in `SHARED`."""

    @classmethod
    def table_of(cls, given: Any) -> Any:
        """Return the table, or look it up if a name is given."""
        shared = _shared().get(cls.__name__)
        if shared is None or not isinstance(given, str):
            return given
        if given not in shared:
            known = ", ".join(sorted(shared))
            raise InputError(f"there is no {given!r}.{did_you_mean(given, shared)} Known: {known}.")
        return shared[given]


class Kinds:
    """Annotation for objects of several kinds, which a table selects by its ``kind``.

    Args:
        makers: dataclasses or functions by kind; the first is the default.
    """

    def __init__(self, **makers: Callable[..., Any]) -> None:
        self._makers = makers

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Return a schema that dispatches on the kind."""
        from pydantic_core.core_schema import tagged_union_schema

        first, *_ = self._makers
        return tagged_union_schema(
            {
                kind: reads(make, _without_kind, handler.generate_schema(make))
                for kind, make in self._makers.items()
            },
            discriminator=lambda table: table.get("kind", first) if isinstance(table, dict) else first,
            custom_error_type="kind",
            custom_error_message=f"The table should have as its kind one of {', '.join(self._makers)}",
        )


class _Listed:
    """Annotation for arrays that are read from lists."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        from pydantic_core.core_schema import no_info_after_validator_function

        return no_info_after_validator_function(_column, handler.generate_schema(tuple[Number, ...]))


Column = Annotated[Doubles, _Listed()]
"""(n,) numbers, read-only because all individuals of a species share them."""


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a species file.

    Raises:
        InputError: if the file cannot be read or is not TOML.
    """
    content = read_named(path)
    try:
        return tomllib.loads(content.decode("utf-8"))
    except ValueError as error:  # an error of tomllib, or of bytes that are not UTF-8
        raise InputError(f"{path} is not a species file, which is TOML: {brief(error)}.") from error


def _without_kind(table: Any) -> Any:
    return {k: v for k, v in table.items() if k != "kind"} if isinstance(table, dict) else table


@cache
def _shared() -> dict[str, Any]:
    return read_toml(SHARED)


def _column(numbers: tuple[float, ...]) -> Doubles:
    column = np.array(numbers, dtype=np.float64)
    column.flags.writeable = False
    return column
