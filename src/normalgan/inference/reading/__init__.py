"""Reading: drawings and their hints on disk."""

__all__ = []
