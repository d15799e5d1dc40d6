"""Store: samples in shards, on disk or at a URL."""

__all__ = []
