"""Reading: drawings as they lie on disk, and the hints given for them."""

__all__ = []
