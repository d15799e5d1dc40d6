"""Line widths that a model accepts; lines outside this range are redrawn for it."""

import math
from collections.abc import Mapping

from normalgan.errors import InputError

LineWidths = tuple[float, float]
"""The thinnest and thickest line that a model saw in training, in pixels at the model's resolution."""
DRAWN_WIDTH = 1.25
"""Width of redrawn lines, which is the default of training samples."""
USUAL_WIDTHS: LineWidths = (0.8, 1.9)
"""Default for models that do not specify a range: lines of about the training width are not redrawn."""


def check_line_widths(widths: object) -> LineWidths:
    """Return the widths from a settings file, after validating them.

    Raises:
        InputError: if ``widths`` is not a pair with `DRAWN_WIDTH` between its two values.
    """
    match widths:
        case [int() | float() as thinnest, int() | float() as thickest] if (
            0 <= thinnest <= DRAWN_WIDTH <= thickest < math.inf
        ):
            return float(thinnest), float(thickest)
    raise InputError(
        f"line_widths is {str(widths)[:40]}; give two: the thinnest and the thickest line that the model is "
        f"shown as drawn, in its pixels, at most and at least {DRAWN_WIDTH}."
    )


def line_widths_of(metadata: Mapping[str, str]) -> LineWidths:
    """Return the line widths from a model file's metadata, or the default for files of older versions.

    Raises:
        InputError: if the entry is not a valid pair of widths.

    >>> line_widths_of({"line_widths": "0.5 5.0"})
    (0.5, 5.0)
    """
    text = metadata.get("line_widths")
    if text is None:
        return USUAL_WIDTHS
    try:
        widths = [float(number) for number in text[:80].split()]
    except ValueError:
        raise InputError(f"its line_widths is {text[:40]!r}; two numbers stand there.") from None
    return check_line_widths(widths)
