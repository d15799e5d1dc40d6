"""Files: atomic writing, reading within limits, checks before loading."""

__all__ = []
