"""Inference: from a drawing to its normal map, by a model as ONNX; numpy, no torch."""

__all__ = []
