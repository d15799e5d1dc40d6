"""Network: its backends, its input, and its map at the drawing's size."""

__all__ = []
