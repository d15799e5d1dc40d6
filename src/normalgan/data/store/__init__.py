"""Store: samples in shards, on disk or behind a URL."""

__all__ = []
