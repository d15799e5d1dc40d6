"""Drawings: what the page sends, within which limits, and how it becomes a drawing in layers."""

__all__ = []
