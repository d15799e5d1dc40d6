"""Mask: the object in a drawing, given as a picture or found from the lines."""

__all__ = []
