"""Reading: read drawings and hints from files."""

__all__ = []
