"""Jobs: rendering in parallel, by processes of one machine or many."""

__all__ = []
