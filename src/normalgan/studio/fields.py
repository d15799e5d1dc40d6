"""Fields: read and check the values of a JSON request."""

import base64
import binascii
import json
from collections.abc import Sequence
from typing import Any

from normalgan.errors import InputError

__all__ = ["LARGEST", "Fields", "parse_fields", "take_bytes", "take_choice", "take_integer", "take_text"]

Fields = dict[str, Any]
LARGEST = 2**53
"""Whole numbers up to here are exact in JavaScript."""


def parse_fields(body: bytes) -> Fields:
    """Return the object in a JSON text.

    Raises:
        InputError: if it is not a JSON object.
    """
    try:
        fields = json.loads(body.decode(), parse_constant=_refuse)
    except (ValueError, RecursionError):  # not UTF-8, NaN, ten thousand digits or brackets
        raise InputError('the request is not JSON; it is like {"tab": "a1", "number": 1, …}.') from None
    if not isinstance(fields, dict):
        raise InputError("the request is not a JSON object with fields in braces.")
    return fields


def _refuse(constant: str) -> None:
    """Refuse NaN and Infinity, which Python accepts and browsers do not."""
    raise ValueError(constant)


def take_integer(fields: Fields, name: str, least: int, most: int, default: int | None = None) -> int:
    """Return a whole number from ``least`` to ``most``; without a default the field is required.

    Raises:
        InputError: if it is none.
    """
    value = fields.get(name, default)
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise InputError(f"{name} is {_shown(value)}; it must be a whole number from {least} to {most}.")
    return value


def take_choice(fields: Fields, name: str, choices: Sequence[str | bool | None], default: Any = None) -> Any:
    """Return one of some values.

    Raises:
        InputError: if it is another.
    """
    value = fields.get(name, default)
    if not any(value is each or (isinstance(each, str) and value == each) for each in choices):
        known = ", ".join(json.dumps(each) for each in choices)
        raise InputError(f"{name} is {_shown(value)}; it must be one of {known}.")
    return value


def take_text(fields: Fields, name: str, most: int) -> str:
    """Return a text of 1 to ``most`` characters.

    Raises:
        InputError: if it is none.
    """
    value = fields.get(name)
    if not isinstance(value, str) or not 1 <= len(value) <= most:
        raise InputError(f"{name} is {_shown(value)}; it must be a text of 1 to {most} characters.")
    return value


def take_bytes(fields: Fields, name: str) -> bytes:
    """Return the bytes of a base64 text.

    Raises:
        InputError: if it is none.
    """
    value = fields.get(name)
    try:
        if isinstance(value, str):
            return base64.b64decode(value, validate=True)
    except (binascii.Error, ValueError):
        pass
    raise InputError(f"{name} is {_shown(value)}; it must be a PNG in base64.")


def _shown(value: Any) -> str:
    if value is None:
        return "missing"
    try:
        text = json.dumps(value, ensure_ascii=False)
    except ValueError:  # an integer of more digits than Python writes
        text = "too long a number"
    return text if len(text) <= 40 else f"{text[:37]}…"
