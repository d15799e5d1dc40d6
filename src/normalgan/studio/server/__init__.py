"""Server: limit requests, refuse foreign pages, and report errors as JSON."""

__all__ = []
