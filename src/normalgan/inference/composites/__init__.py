"""Composites: files with several drawings, such as sprite sheets, animations and layered files."""

__all__ = []
