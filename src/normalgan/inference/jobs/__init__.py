"""Jobs: which drawings to predict, and where their maps go."""

__all__ = []
