"""Weights: reading and writing generators as safetensors or ONNX without running code; shipped models."""

__all__ = []
