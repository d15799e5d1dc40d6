from normalgan.rendering.media.medium import Medium

__all__ = ["Medium"]
