from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["Stroke"]
