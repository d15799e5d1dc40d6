"""Checks that the line styles share."""

from dataclasses import fields
from typing import Any

from normalgan.errors import InputError
from normalgan.rendering.maps import Maps


def check_settings(style: Any, positive: tuple[str, ...]) -> None:
    """Raise `InputError` if a setting of a style is negative, or 0 and among those named ``positive``."""
    for field in fields(style):
        value = getattr(style, field.name)
        if field.name in positive and not value > 0:
            raise InputError(f"{field.name} of {type(style).__name__} is {value}; it must be greater than 0.")
        if value is not None and not value >= 0:
            raise InputError(f"{field.name} of {type(style).__name__} is {value}; it cannot be negative.")


def check_maps(maps: Maps, size: int, supersampling: int) -> None:
    """Raise `InputError` if the maps are not ``supersampling`` times the sketch's size."""
    side = size * supersampling
    if maps.mask.shape != (side, side):
        raise InputError(
            f"the maps are {maps.mask.shape[1]} × {maps.mask.shape[0]} pixels; a sketch of {size} pixels "
            f"with supersampling {supersampling} is drawn from {side} × {side}."
        )
