"""Strokes as SVG, with one path per stroke, for editing in vector programs."""

from collections.abc import Sequence

import numpy as np

from normalgan.arrays import Doubles
from normalgan.rendering.strokes.stroke import Stroke

_PLACE_TOLERANCE = 0.05  # in pixels; points closer to the line between their neighbours are left out
_WIDTH_TOLERANCE = 0.01  # in pixels; smaller variations of the width are ignored


def to_svg(strokes: Sequence[Stroke], size: int) -> str:
    """Return the drawing as an SVG document of ``size`` × ``size`` pixels on transparent paper.

    A stroke of constant width becomes a line with that ``stroke-width``, and a stroke of varying width
    becomes a filled shape. An SVG path has a single opacity, so the mean darkness of the stroke is used.

    Args:
        strokes: strokes in drawing order.
        size: side of the drawing in pixels.

    Example:
        >>> line = Stroke.even(np.array([[1.0, 1.0], [3.0, 1.5]]), width=1.25)
        >>> print(to_svg([line], 4))
        <svg xmlns="http://www.w3.org/2000/svg" width="4" height="4" viewBox="0 0 4 4">
        <g fill="none" stroke="#000" stroke-linecap="round" stroke-linejoin="round">
        <path stroke-width="1.25" d="M1 1L3 1.5"/>
        </g>
        </svg>
    """
    sides = f'width="{size}" height="{size}" viewBox="0 0 {size} {size}"'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {sides}>',
            '<g fill="none" stroke="#000" stroke-linecap="round" stroke-linejoin="round">',
            *(_path(stroke) for stroke in strokes),
            "</g>",
            "</svg>",
        ]
    )


def _path(stroke: Stroke) -> str:
    darkness = float(stroke.darkness.mean())
    opacity = "" if darkness > 0.999 else f' opacity="{darkness:.3g}"'
    if np.ptp(stroke.width) < _WIDTH_TOLERANCE:
        end = "Z" if stroke.closed else ""
        points = stroke.points[:-1] if stroke.closed else stroke.points
        return f'<path stroke-width="{_number(stroke.width[0])}"{opacity} d="{_data(points)}{end}"/>'
    shape = "".join(_data(ring) + "Z" for ring in outline(stroke))
    return f'<path fill="#000" stroke="none"{opacity} d="{shape}"/>'


def _data(points: Doubles) -> str:
    from skimage.measure import approximate_polygon  # imports scipy.signal, which takes half a second

    points = approximate_polygon(points, _PLACE_TOLERANCE)
    return "M" + "L".join(f"{_number(x)} {_number(y)}" for x, y in points)


def _number(value: float) -> str:
    """Format a number with two decimals, without trailing zeros.

    >>> [_number(1.5), _number(2.0), _number(-0.001)]
    ['1.5', '2', '0']
    """
    return f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")


_CAP_CORNERS = 6  # number of corners of a round end, invisible at the width of a pen


def outline(stroke: Stroke) -> list[Doubles]:
    """Return the outline of a stroke as rings (R, 2) for nonzero filling, without repeated first points.

    The two sides are half a width away from the points and are joined by round ends. A closed stroke has
    one ring per side.

    >>> bar = Stroke.even(np.array([[0.0, 0.0], [4.0, 0.0]]), width=2)
    >>> [ring.round().astype(int)[:2].tolist() for ring in outline(bar)]
    [[[0, 1], [4, 1]]]
    """
    along = _tangents(stroke.points, stroke.closed)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) * stroke.width[:, None] / 2
    left, right = stroke.points + across, stroke.points - across
    if stroke.closed:
        return [left[:-1], right[:0:-1]]
    first, last = (
        _cap(stroke.points[end], sign * across[end], stroke.width[end]) for end, sign in ((0, -1), (-1, 1))
    )
    return [np.concatenate([left, last, right[::-1], first])]


def _tangents(points: Doubles, closed: bool) -> Doubles:
    """Return the unit tangents of a stroke at its points."""
    steps = np.diff(points, axis=0)
    if closed:
        before, after = np.vstack([steps[-1:], steps]), np.vstack([steps, steps[:1]])
    else:
        before, after = np.vstack([steps[:1], steps]), np.vstack([steps, steps[-1:]])
    tangents = before + after
    # Where the pen reverses, the two steps cancel, so the incoming direction is used.
    still = np.linalg.norm(tangents, axis=1) < 1e-9
    tangents[still] = before[still]
    unit: Doubles = tangents / np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12)
    return unit


def _cap(end: Doubles, side: Doubles, width: float) -> Doubles:
    """Return the corners of a half circle around ``end`` that starts after ``side`` and runs clockwise."""
    angles = np.linspace(0, np.pi, _CAP_CORNERS + 2)[1:-1]
    radius = width / 2
    start = side / max(float(np.linalg.norm(side)), 1e-12)
    over = np.array([start[1], -start[0]])
    corners: Doubles = end + radius * (np.cos(angles)[:, None] * start + np.sin(angles)[:, None] * over)
    return corners
