"""Jobs: which files are predicted, and where their maps go."""

__all__ = []
