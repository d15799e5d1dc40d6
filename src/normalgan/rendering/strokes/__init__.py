from normalgan.rendering.strokes.chain import chain
from normalgan.rendering.strokes.curves import resample, settle, smooth
from normalgan.rendering.strokes.raster import rasterise
from normalgan.rendering.strokes.stroke import Stroke

__all__ = ["Stroke", "chain", "rasterise", "resample", "settle", "smooth"]
