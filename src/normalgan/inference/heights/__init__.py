"""Heights: the surface of a normal map, and meshes of it."""

__all__ = []
