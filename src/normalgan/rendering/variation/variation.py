"""Variation: strengths of the random variation of a shape."""

from dataclasses import dataclass, fields, replace
from typing import Annotated

from normalgan.ranges import Range, check_ranges

_Part = Annotated[float, Range(0, 0.9)]  # so that nothing shrinks to zero


@dataclass(frozen=True)
class Variation:
    """How much variants differ from their mesh. If all strengths are 0, variants are identical to it.

    Args:
        scale: independent stretching or shrinking of length, height and width; 0.1 means up to 10 %.
        taper: thickening towards one end; 0.1 changes each end by up to 10 %.
        bend: maximum angle in degrees between the directions of the two ends, up or down. The sideways
            angle is this times ``asymmetry``.
        twist: maximum angle in degrees between the two ends about the long axis, multiplied by
            ``asymmetry``.
        limb_length: lengthening or shortening of the legs, the part below the belly; 0.2 means up to 20 %.
        limb_thickness: thickening or thinning of limbs, ears and tails; 0.2 means up to 20 %.
        parts: growth or shrinking of three random parts, such as a head or a belly.
        lattice: random displacements of a lattice of 4 × 4 × 4 points around the object, as a fraction of
            its size.
        bumps: height of a dozen bumps and hollows, as a fraction of their width.
        asymmetry: difference between left and right. 0 mirrors all changes. It has no effect on its own.
        joints: maximum angle in degrees by which limbs bend, at joints found on the surface without a
            skeleton. 0 by default.
        tilt: maximum angle in degrees by which the object leans, in any direction; small angles are more
            likely. 0 by default.

    Raises:
        InputError: if a strength is negative, or so large that the object would be unrecognisable.

    Example:
        >>> Variation(bend=30.0).times(0.5).bend
        15.0
    """

    scale: _Part = 0.12
    taper: _Part = 0.12
    bend: Annotated[float, Range(0, 180)] = 12.0
    twist: Annotated[float, Range(0, 360)] = 20.0
    limb_length: _Part = 0.2
    limb_thickness: _Part = 0.25
    parts: _Part = 0.2
    lattice: _Part = 0.06
    bumps: _Part = 0.15
    asymmetry: _Part = 0.4
    joints: Annotated[float, Range(0, 90)] = 0.0
    tilt: Annotated[float, Range(0, 180)] = 0.0

    def __post_init__(self) -> None:
        """Check that all strengths are in range."""
        check_ranges(self)

    def times(self, amount: float) -> "Variation":
        """Return all strengths multiplied by ``amount``, except the asymmetry, which is relative to them."""
        strengths = {field.name: getattr(self, field.name) * amount for field in fields(self)}
        return replace(self, **{**strengths, "asymmetry": self.asymmetry})

    def none(self) -> bool:
        """Return whether all strengths are 0, so that variants are identical to the mesh."""
        return not any(getattr(self, field.name) for field in fields(self) if field.name != "asymmetry")
