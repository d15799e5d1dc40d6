"""The network's side: who runs it, what of a drawing it is shown, and its map at the drawing's size."""

__all__ = []
