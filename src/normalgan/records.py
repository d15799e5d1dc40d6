"""Records: dataclasses that pydantic reads from the content of a file, so that it names a wrong field."""

from collections.abc import Callable, Mapping
from functools import cache
from inspect import signature
from typing import TYPE_CHECKING, Any, TypeVar

from normalgan.errors import InputError, did_you_mean, sentence_of

if TYPE_CHECKING:
    from pydantic import TypeAdapter

__all__ = ["Record", "read_record", "reads"]

T = TypeVar("T")


class Record:
    """The base of such dataclasses: unknown fields are refused."""

    @classmethod
    def table_of(cls, given: Any) -> Any:
        """Return the table that stands for an object; a subclass may look names up."""
        return given

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Look at the names of the fields before pydantic reads them."""
        schema = handler(source)
        # By its ref, pydantic uses a schema again where a class appears again: this one, not the one within.
        within = {key: value for key, value in schema.items() if key != "ref"}
        return reads(cls, cls.table_of, within, schema.get("ref"))


def read_record(kind: type[T], content: Mapping[str, Any]) -> T:
    """Return the record that a file's content describes.

    Args:
        kind: a `Record`.
        content: its fields, from YAML, TOML or JSON.

    Raises:
        InputError: if a field is unknown, missing or wrong; the sentence names it, but not the file.
    """
    from pydantic import ValidationError

    cls: Any = kind  # to mypy, a type is not hashable
    try:
        read: T = _adapter(cls).validate_python(content)
    except ValidationError as error:
        raise InputError(sentence_of(error, "the file")) from error
    return read


def reads(
    make: Callable[..., Any], table_of: Callable[[Any], Any], schema: Any, ref: str | None = None
) -> Any:
    """Return pydantic's schema for what a dataclass or a function makes of a table.

    Args:
        make: the dataclass or function.
        table_of: returns the table, given what the file holds.
        schema: pydantic's schema of ``make``.
        ref: name of the whole schema.
    """
    from pydantic_core.core_schema import no_info_wrap_validator_function

    def read(given: Any, rest: Callable[[Any], Any]) -> Any:
        table = table_of(given)
        fields = signature(make).parameters
        for name in table if isinstance(table, Mapping) else ():
            if name not in fields:
                hint = did_you_mean(str(name), fields)
                raise InputError(f"{name} is not known.{hint} Known: {', '.join(fields)}.")
        return rest(table)

    # It wraps, so that pydantic names the field where ``make`` itself refuses its arguments.
    return no_info_wrap_validator_function(read, schema, ref=ref)


@cache
def _adapter(kind: Any) -> "TypeAdapter[Any]":
    from pydantic import TypeAdapter

    return TypeAdapter(kind)
