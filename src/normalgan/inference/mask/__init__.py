"""Mask: the object in a drawing, given as a picture or found in the lines."""

__all__ = []
