from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.brush import Brush
from normalgan.rendering.lines.contours import OccludingContours, Silhouette
from normalgan.rendering.lines.mixture import Mixture
from normalgan.rendering.lines.object_space import ObjectSpaceSuggestive
from normalgan.rendering.lines.ridges import RidgesAndValleys
from normalgan.rendering.lines.suggestive import SuggestiveContours

__all__ = [
    "LINE_DRAWINGS",
    "Brush",
    "LineDrawing",
    "Mixture",
    "ObjectSpaceSuggestive",
    "OccludingContours",
    "RidgesAndValleys",
    "Silhouette",
    "SuggestiveContours",
]
