"""Records: dataclasses that pydantic fills from a file's content, with errors that name the wrong field."""

from collections.abc import Callable, Mapping
from functools import cache
from inspect import signature
from typing import TYPE_CHECKING, Any, TypeVar

from normalgan.errors import InputError, did_you_mean, sentence_of

if TYPE_CHECKING:
    from pydantic import TypeAdapter

T = TypeVar("T")


class Record:
    """Base class of dataclasses that are read from files; unknown fields are refused."""

    @classmethod
    def table_of(cls, given: Any) -> Any:
        """Return the table that describes an object; a subclass may also accept a name and look it up."""
        return given

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Check the field names before pydantic reads the fields."""
        schema = handler(source)
        # pydantic reuses schemas by ref, so the ref must belong to the wrapping schema, not to the inner
        # one.
        within = {key: value for key, value in schema.items() if key != "ref"}
        return reads(cls, cls.table_of, within, schema.get("ref"))


def read_record(kind: type[T], content: Mapping[str, Any]) -> T:
    """Return the record that a file's content describes.

    Args:
        kind: a `Record`.
        content: its fields, from YAML, TOML or JSON.

    Raises:
        InputError: if a field is unknown, missing or invalid; the message names the field but not the
            file.
    """
    from pydantic import ValidationError

    cls: Any = kind  # mypy does not consider a type hashable
    try:
        read: T = _adapter(cls).validate_python(content)
    except ValidationError as error:
        raise InputError(sentence_of(error, "the file")) from error
    return read


def reads(
    make: Callable[..., Any], table_of: Callable[[Any], Any], schema: Any, ref: str | None = None
) -> Any:
    """Return a pydantic schema that builds an object from a table and refuses unknown fields.

    Args:
        make: dataclass or function that builds the object.
        table_of: function that turns a file's value into the table.
        schema: pydantic's schema of ``make``.
        ref: reference name of the returned schema.
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

    # A wrap validator, so that pydantic also names the field if ``make`` refuses its arguments.
    return no_info_wrap_validator_function(read, schema, ref=ref)


@cache
def _adapter(kind: Any) -> "TypeAdapter[Any]":
    from pydantic import TypeAdapter

    return TypeAdapter(kind)
