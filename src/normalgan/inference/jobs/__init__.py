"""Jobs: find the drawings to predict, and decide where their maps go."""

__all__ = []
