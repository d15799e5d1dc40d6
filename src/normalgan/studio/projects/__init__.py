"""Projects: saved documents, how they are kept in a folder, and what the page opens first."""

__all__ = []
