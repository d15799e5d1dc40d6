"""Format: check the format and version of a saved project."""

from typing import Any

from pydantic import ValidationError

from normalgan.errors import InputError, sentence_of
from normalgan.studio.drawings.schemas import Schema, Side, parse_object

FORMAT, VERSION = "normalgan-studio", 5
_ONE_LAYER = 3
"""Last version without layers; in these versions, ``layers`` are pictures for tracing."""


class _Project(Schema):
    """Fields of every project; the page checks the content of the lists."""

    width: Side
    height: Side
    layers: list[Any]
    settings: dict[str, Any]


class _OneLayer(_Project):
    strokes: list[Any]
    hints: list[Any]


class _Layered(_Project):
    pictures: list[Any]


def check_document(content: bytes) -> dict[str, Any]:
    """Return a project's fields.

    Raises:
        InputError: if the content is not a project, or was saved by a later version.
    """
    fields = parse_object(content)
    if fields.get("format") != FORMAT:
        raise InputError(f'that is not a studio project, which begins with "format": "{FORMAT}".')
    if fields.get("version") not in range(1, VERSION + 1):
        raise InputError(
            f"the project has an unknown version; this studio supports 1 to {VERSION}, so update normalgan."
        )
    schema = _Layered if fields["version"] > _ONE_LAYER else _OneLayer
    try:
        schema.model_validate(fields)
    except ValidationError as error:
        raise InputError(f"the project is damaged: {sentence_of(error)}") from None
    return fields
