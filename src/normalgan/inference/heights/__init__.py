"""Heights: integrate a normal map to a surface, and build meshes of it."""

__all__ = []
