"""Number types with ranges, for the options of commands without Lightning."""

from jsonargparse.typing import restricted_number_type

from normalgan.inference.reading.drawings import LARGEST, SMALLEST

Side = restricted_number_type("Side", int, [(">=", SMALLEST), ("<=", LARGEST)])
"""Side of a map or a drawing in pixels."""
ModelSide = restricted_number_type("ModelSide", int, (">=", 8))
"""Side of a network's input in pixels."""
Strength = restricted_number_type("Strength", float, [(">=", 0), ("<=", 100)])
"""Factor applied to slopes."""
Margin = restricted_number_type("Margin", float, [(">=", 0), ("<", 0.5)])
"""Margin as a fraction of a side."""
Degrees = restricted_number_type("Degrees", float, [(">=", 1), ("<=", 120)])
"""Field of view in degrees."""
