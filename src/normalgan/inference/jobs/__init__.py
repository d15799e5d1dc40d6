"""Jobs: which files are painted, and where their maps go."""

__all__ = []
