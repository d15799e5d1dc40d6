"""normalgan generate: its options, and the drawings that it goes through."""

__all__ = []
