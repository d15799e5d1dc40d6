"""Benchmark: compares methods on one split, with one renderer, one budget and the same hints."""

__all__ = []
