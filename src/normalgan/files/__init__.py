"""Files: atomic writing, reading within limits, and checks before loading."""

__all__ = []
