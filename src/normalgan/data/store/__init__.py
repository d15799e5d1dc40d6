"""Store: samples on disk or behind a URL, in shards, and what a folder of them is."""

__all__ = []
