"""Types of the numbers that light commands take: the parser checks their range, and `--help` names it."""

from jsonargparse.typing import restricted_number_type

from normalgan.inference.reading.drawings import LARGEST, SMALLEST

__all__ = ["Degrees", "Margin", "ModelSide", "Side", "Strength"]

Side = restricted_number_type("Side", int, [(">=", SMALLEST), ("<=", LARGEST)])
"""Pixels of a map or a drawing."""
ModelSide = restricted_number_type("ModelSide", int, (">=", 8))
"""Pixels of the pictures that a network is shown."""
Strength = restricted_number_type("Strength", float, [(">=", 0), ("<=", 100)])
"""What slopes are multiplied by."""
Margin = restricted_number_type("Margin", float, [(">=", 0), ("<", 0.5)])
"""Share of a side that is left free."""
Degrees = restricted_number_type("Degrees", float, [(">=", 1), ("<=", 120)])
"""A field of view."""
