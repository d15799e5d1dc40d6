"""Projects: store and serve saved documents, and find the one that the page opens first."""

__all__ = []
