"""Weights: a generator as safetensors, read without running code; and the shipped one."""

__all__ = []
