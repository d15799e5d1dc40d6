"""The comparison of methods: one split, one renderer, one budget, the same hints for all."""

__all__ = []
