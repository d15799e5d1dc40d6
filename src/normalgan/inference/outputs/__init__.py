"""Outputs: what is written for a drawing: maps, pictures of them, and files for engines."""

__all__ = []
