"""glTF 2.0: its container, its numbers, its nodes, and the triangles that its scene shows."""

__all__ = []
