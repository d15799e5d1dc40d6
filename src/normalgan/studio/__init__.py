"""The studio: a page in the browser to draw, pin normals, light and export; served to this machine alone."""

__all__ = []
