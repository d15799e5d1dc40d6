"""Weights: a generator as safetensors, read without running anything; and that which the package brings."""

__all__ = []
