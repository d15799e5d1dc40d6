from normalgan.rendering.lines.base import LINE_DRAWINGS, LineDrawing
from normalgan.rendering.lines.occluding import OccludingContours
from normalgan.rendering.lines.suggestive import SuggestiveContours

__all__ = ["LINE_DRAWINGS", "LineDrawing", "OccludingContours", "SuggestiveContours"]
