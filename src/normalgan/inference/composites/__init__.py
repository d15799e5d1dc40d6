"""Several drawings in one file: sheets of sprites, animations, layers."""

__all__ = []
