"""glTF 2.0: container, accessors, nodes, and the triangles of the scene."""

__all__ = []
