"""Inference: predict the normal map of a drawing with an ONNX model, in NumPy and without torch."""

__all__ = []
