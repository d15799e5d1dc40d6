"""From a drawing as it was made to its normal map, through a model as ONNX; numpy, no torch."""

__all__ = []
