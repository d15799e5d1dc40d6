"""Variation: how far individuals of one shape differ."""

from dataclasses import dataclass, fields, replace
from typing import Annotated

from normalgan.ranges import Range, check_ranges

__all__ = ["Variation"]

_Part = Annotated[float, Range(0, 0.9)]  # so that nothing shrinks to nothing


@dataclass(frozen=True)
class Variation:
    """How far variants differ from their mesh; without any strength it is the mesh.

    Args:
        scale: independent lengthening or shortening along, up and sideways: 0.1 is up to a tenth.
        taper: how much thicker the object becomes towards one end: 0.1 changes each end by up to a tenth.
        bend: largest angle in degrees between the directions of the two ends, up or down; sideways it is this
            times ``asymmetry``.
        twist: largest angle in degrees between the two ends, about the long axis, times ``asymmetry``.
        limb_length: lengthening or shortening of the legs, the part below the belly: 0.2 is up to a fifth.
        limb_thickness: thickening or thinning of limbs, ears and tails: 0.2 is up to a fifth.
        parts: growth or shrinking of three parts anywhere, such as a head or a belly.
        lattice: random pulls at a lattice of 4 × 4 × 4 points about the object, as a share of its size.
        bumps: height of a dozen bumps and hollows, as a share of their width.
        asymmetry: how much left and right differ: 0 mirrors all changes; it alone changes nothing.
        joints: largest angle in degrees by which limbs bend, at places found on the surface; no skeleton is
            needed. By default none do.
        tilt: largest angle in degrees by which it leans or lies, to any side; most lean little. By default it
            stands.

    Raises:
        InputError: if a strength is negative, or so large that nothing recognisable would be left.

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
        """Check that all strengths are finite and leave a shape."""
        check_ranges(self)

    def times(self, amount: float) -> "Variation":
        """Return all strengths times ``amount``; the asymmetry, a share of the others, stays."""
        strengths = {field.name: getattr(self, field.name) * amount for field in fields(self)}
        return replace(self, **{**strengths, "asymmetry": self.asymmetry})

    def none(self) -> bool:
        """Return whether no strength is left, so that every individual is the mesh itself."""
        return not any(getattr(self, field.name) for field in fields(self) if field.name != "asymmetry")
