"""Inside: from marks on the mesh to a few long, fading strokes within an object."""

from dataclasses import dataclass

import numpy as np

from normalgan.arrays import Doubles, Floats
from normalgan.rendering.lines.buffers import Buffers
from normalgan.rendering.lines.runs import worthy_runs
from normalgan.rendering.lines.surface import Surface
from normalgan.rendering.lines.surface_lines import EdgeMarks, paths, seen
from normalgan.rendering.strokes.curves import SPACING, lengths_along, resample, smooth
from normalgan.rendering.strokes.stroke import Stroke
from normalgan.rendering.view import View

__all__ = ["Inside"]

_FINE = 0.25  # `SPACING` while smoothing
_FAINTEST = 0.4  # share of its width that a stroke keeps where it is weakest


@dataclass(frozen=True)
class Inside:
    """How strokes inside an object are drawn; lengths are fractions of the frame's side.

    Args:
        width: width of a strong stroke in pixels of the sketch.
        strength: that a stroke must reach; it continues down to a third of it.
        shortest: strokes shorter than this are left out.
        bridge: gaps up to this do not break a stroke.
        apart: strokes that on average keep nearer than this to a contour are left out.
        smoothing: standard deviation of the smoothing of a stroke; a line on a mesh jerks from edge to edge.
    """

    width: float
    strength: float
    shortest: float
    bridge: float
    apart: float
    smoothing: float = 0.006

    def draw(
        self,
        surface: Surface,
        view: View,
        buffers: Buffers,
        distance: Floats,
        marks: EdgeMarks,
        strength: Doubles,
    ) -> list[Stroke]:
        """Return the strokes along marks on a mesh.

        Args:
            surface: the mesh.
            view: how it is seen.
            buffers: buffers of the view; points that they do not show count as hidden.
            distance: (H, W) in pixels of the buffers to the nearest contour.
            marks: N places on edges of the mesh.
            strength: (N,) of the line there.
        """
        place, visible = seen(view, buffers, marks.take(surface, surface.vertices))
        kept = visible & (strength > 0)
        marks, place, strength = marks.only(kept), place[kept], strength[kept]
        column, row = np.floor(place * buffers.scale - buffers.corner).astype(np.int64).T
        height, width = distance.shape
        away = distance[row.clip(0, height - 1), column.clip(0, width - 1)] / buffers.side
        strokes = []
        for path in paths(surface, marks, place):
            points, strong = place[path] / view.size, strength[path]
            for part in worthy_runs(
                points, strong, self.strength / 3, self.strength, self.bridge, self.shortest
            ):
                if away[path][part].mean() > self.apart:
                    strokes.append(self._stroke(points[part] * view.size, strong[part], view.size))
        return strokes

    def _stroke(self, points: Doubles, strength: Doubles, size: int) -> Stroke:
        along = lengths_along(points)
        fine = resample(points, _FINE)
        path = resample(smooth(fine, self.smoothing * size / _FINE), SPACING)
        share = np.clip(strength / self.strength, 0, 1)
        here = np.interp(np.linspace(0, along[-1], len(path)), along, share)
        pressure = smooth(np.stack([here, here], axis=1), 3.0)[:, 0]
        width = self.width * (_FAINTEST + (1 - _FAINTEST) * np.clip(pressure, 0, 1))
        return Stroke(path, width, np.ones(len(path)))
