from normalgan.registry import import_modules
from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.brush import Brush
from normalgan.rendering.lines.buffers import BufferedDrawing
from normalgan.rendering.lines.contours import OccludingContours, OutlinedDrawing, Silhouette
from normalgan.rendering.lines.mixture import Mixture
from normalgan.rendering.lines.object_space import ObjectSpaceSuggestive
from normalgan.rendering.lines.ridges import RidgesAndValleys
from normalgan.rendering.lines.suggestive import SuggestiveContours
from normalgan.rendering.lines.surface_lines import SurfaceDrawing

import_modules(__name__)

__all__ = [
    "LINE_DRAWINGS",
    "Brush",
    "BufferedDrawing",
    "LineDrawing",
    "Mixture",
    "ObjectSpaceSuggestive",
    "OccludingContours",
    "OutlinedDrawing",
    "RidgesAndValleys",
    "Silhouette",
    "SuggestiveContours",
    "SurfaceDrawing",
]
