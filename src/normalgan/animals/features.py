"""Features that many heads share: nostrils and ears, in units of the head's length."""

from normalgan.animals.species import Ornament

Point = tuple[float, float, float]


def nostril(at: Point, radius: float) -> Ornament:
    """Return a pair of nostrils, dug in."""
    x, y, z = at
    rows = ((x, y, z, radius, radius), (x + 0.04, y + 0.02, z - 0.01, radius * 0.8, radius * 0.8))
    return Ornament(rows, carve=True, blend=0.008)


def leaf_ear(
    at: Point, to: Point, width: float, thick: float, side: Point, swivel: float = 18.0, pricked: bool = False
) -> Ornament:
    """Return a pair of ears shaped like leaves: wide in the middle, pointed.

    Args:
        at: base of the right one.
        to: its tip.
        width: half of its greatest width.
        thick: half of its thickness.
        side: direction of the width.
        swivel: degrees of individual difference.
        pricked: widest at the base instead, as a cat's.
    """
    outline = (1.0, 0.95, 0.78, 0.5, 0.12) if pricked else (0.55, 0.88, 1.0, 0.72, 0.16)
    rows = tuple(
        (*(a + (b - a) * t for a, b in zip(at, to, strict=True)), thick * (1.15 - 0.4 * t), width * wide)
        for t, wide in zip((0.0, 0.25, 0.5, 0.75, 1.0), outline, strict=True)
    )
    return Ornament(rows, scale="ears", side=side, blend=0.015, swivel=swivel)
