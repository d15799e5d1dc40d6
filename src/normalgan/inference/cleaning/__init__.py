"""Cleaning: extract a drawing's ink from its colours and opacity."""

__all__ = []
