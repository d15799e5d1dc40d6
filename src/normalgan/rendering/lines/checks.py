"""Checks that the line styles share."""

from dataclasses import fields
from typing import Any

from normalgan.errors import InputError

__all__ = ["check_settings"]


def check_settings(style: Any, positive: tuple[str, ...]) -> None:
    """Raise `InputError` if a setting of a style is negative, or 0 and among those named ``positive``."""
    for field in fields(style):
        value = getattr(style, field.name)
        if field.name in positive and not value > 0:
            raise InputError(f"{field.name} of {type(style).__name__} is {value}; it must be greater than 0.")
        if value is not None and not value >= 0:
            raise InputError(f"{field.name} of {type(style).__name__} is {value}; it cannot be negative.")
