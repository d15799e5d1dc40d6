from normalgan.rendering.hand.hand import Hand

__all__ = ["Hand"]
