"""The studio: a page for drawing, pinning normals, lighting and exporting, served to this machine only."""

__all__ = []
