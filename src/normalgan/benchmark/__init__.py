"""Benchmark: compare methods on the same split, with the same renderer, budget and hints."""

__all__ = []
