"""Server: reads requests within limits, refuses those of other pages, and answers errors in JSON."""

__all__ = []
