"""Weights: a generator as safetensors or ONNX, read without running code; and the shipped one."""

__all__ = []
