"""The files of weights that come with the package; no torch."""

from pathlib import Path

__all__ = ["READER", "REFINER", "SHIPPED", "SHIPPED_NAME"]

_HERE = Path(__file__).parent
SHIPPED = _HERE / "ours.onnx"
"""The model: ONNX Runtime runs it, and torch reads its weights."""
SHIPPED_NAME = "shipped"
"""What it is called where a file is asked for."""
REFINER = _HERE / "refiner.onnx"
"""Brings the model's maps to a drawing's own size."""
READER = _HERE / "reader.onnx"
"""Tells lines from the page, and the object from air."""
