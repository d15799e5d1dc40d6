"""normalgan generate: options, and processing of the named drawings."""

__all__ = []
