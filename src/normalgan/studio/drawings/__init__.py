"""Drawings: parse and check what the page sends, and turn it into a drawing in layers."""

__all__ = []
