"""Line width: redraw lines at a width that the model knows from training."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.medians import median
from normalgan.inference.network.framing import Frame
from normalgan.inference.regions import around, depth_of
from normalgan.line_widths import DRAWN_WIDTH, LineWidths

_FINER = 4
"""Resolution at which lines are thinned, as a multiple of the model's."""
_ROUGH = 2
"""Resolution of the quick test for lines that need no redrawing, as a multiple of the model's."""
_THIN = 0.02
"""Minimum half width of an area, as a fraction of the model's side; thinner parts are lines."""
_THINNEST = 1.75
"""Minimum half width of an area in pixels of the drawing; in a figure of 20 pixels, each line is a tenth."""


def render_model_input(ink: Floats, frame: Frame, widths: LineWidths) -> Floats:
    """Return the model's input for a drawing: ink (size, size) in [0, 1].

    Narrow lines are thickened. Wide lines are redrawn along their centre line, which loses some of their
    character. Filled areas are replaced by their outline.

    Args:
        ink: (H, W), the drawing.
        frame: the square of the drawing that is the model's input.
        widths: range of line widths that the model knows.
    """
    if _is_known(ink, frame, widths):
        return frame.cut(ink)
    whole = _finer(frame, _FINER).marked(ink)
    # Empty parts, which make up most of the frame of a long drawing, are skipped.
    box = around(whole, 2 * _FINER)
    inked = whole[box]
    depth = depth_of(inked)
    width = _width(inked, depth)
    thick = areas(inked, width, depth, frame.size * _FINER, frame.size * _FINER / frame.side)
    if thick.any():
        width = _width(inked & ~thick, depth)
    kept, drawn_width = None, DRAWN_WIDTH * _FINER
    if widths[0] * _FINER <= width <= widths[1] * _FINER:
        if not thick.any():
            return frame.cut(ink)
        lines, kept = _edge(inked, thick), inked & ~thick
    elif thick.any() or width > widths[1] * _FINER:
        lines = middle(inked, width, thick)
    else:
        lines, drawn_width = inked, DRAWN_WIDTH * _FINER - width + 1
    away = cv2.distanceTransform((~lines).view(np.uint8), cv2.DIST_L2, 5)
    drawn = np.zeros(whole.shape, np.float32)
    np.clip(np.float32(drawn_width / 2 + 0.5) - away, 0, 1, out=drawn[box])
    if kept is not None:
        drawn[box][kept] = 1
    shown = cv2.resize(drawn, (frame.size, frame.size), interpolation=cv2.INTER_AREA)
    return np.asarray(shown, np.float32)


def _is_known(ink: Floats, frame: Frame, widths: LineWidths) -> bool:
    """Return whether all lines have a known width and there are no filled areas.

    The test runs at half the resolution, where a width is accurate to one pixel. It returns False if one
    pixel could make the difference.
    """
    marked = _finer(frame, _ROUGH).marked(ink)
    inked = marked[around(marked, 1)]
    depth = depth_of(inked)
    known = widths[0] * _ROUGH + 1 <= _width(inked, depth) <= widths[1] * _ROUGH - 1
    return known and float(depth.max()) + 1 <= _THIN * frame.size * _ROUGH


def _finer(frame: Frame, times: int) -> Frame:
    return Frame(frame.shape, frame.left, frame.top, frame.side, frame.size * times)


def line_width(inked: BoolMask) -> float:
    """Return the median width of the lines of a drawing (H, W) in pixels.

    >>> inked = np.zeros((60, 60), bool)
    >>> inked[10:15] = inked[30:35] = True
    >>> round(line_width(inked))
    5
    """
    inked = inked[around(inked, 1)]
    return _width(inked, depth_of(inked))


def _width(inked: BoolMask, depth: Floats) -> float:
    # Pixels at least as deep inside the ink as their neighbours lie on the centre line.
    ridge = inked & (depth >= cv2.dilate(depth, np.ones((3, 3), np.uint8)) - np.float32(1e-4))
    return median(2 * depth[ridge] - 1) if ridge.any() else 0.0


def areas(inked: BoolMask, width: float, depth: Floats, side: int, drawn_pixel: float) -> BoolMask:
    """Return the parts (H, W) of a drawing that are too thick to be lines.

    A connected patch that is mostly thick is an area including its thin parts, such as the legs of a
    silhouette.

    Args:
        inked: (H, W), the ink.
        width: width of most lines in pixels.
        depth: (H, W), distance of each pixel from the edge of the ink.
        side: side of the whole picture in pixels.
        drawn_pixel: side of the drawing's pixels in pixels of the picture, which may be enlarged.
    """
    thickest = min(max(1.5 * width, _THIN * side), 0.035 * side)  # maximum half width of a line
    thickest = max(thickest, _THINNEST * drawn_pixel)
    core: BoolMask = depth > thickest
    if not core.any():
        return core
    away = cv2.distanceTransform((~core).astype(np.uint8), cv2.DIST_L2, 5)
    thick: BoolMask = inked & np.asarray(away <= 1.2 * thickest)
    count, found = cv2.connectedComponents(inked.astype(np.uint8), connectivity=8)
    labels = np.asarray(found, np.int32)
    whole = np.maximum(np.bincount(labels.ravel(), minlength=count), 1)  # there may be no paper
    share = np.bincount(labels[thick], minlength=count) / whole
    return np.asarray(thick | (inked & (share > 0.5)[labels]))


def middle(inked: BoolMask, width: float, thick: BoolMask) -> BoolMask:
    """Return one-pixel lines (H, W): the centre lines of a drawing's lines and the outlines of its areas.

    Uses scikit-image's implementation of Zhang and Suen 1984, "A Fast Parallel Algorithm for Thinning Digital
    Patterns".

    Args:
        inked: (H, W), the ink.
        width: width of most lines in pixels.
        thick: (H, W), the areas, from `areas`.
    """
    from skimage.morphology import skeletonize  # takes half a second, and most drawings do not need it

    blur = max(width / 4, 0.5)  # a skeleton has spurs where edges are rough
    smooth = cv2.GaussianBlur(inked.astype(np.float32), (0, 0), blur) > 0.5
    # The blur erases lines much thinner than the others, such as the eyes of a face with a thick outline.
    lost = inked & (cv2.distanceTransform((~smooth).view(np.uint8), cv2.DIST_L2, 5) > blur)
    if lost.any():
        smooth |= inked & (cv2.distanceTransform((~lost).view(np.uint8), cv2.DIST_L2, 5) <= blur)
    lines: BoolMask = skeletonize(smooth & ~thick)
    return lines | _edge(inked, thick)


def _edge(inked: BoolMask, thick: BoolMask) -> BoolMask:
    """Return the outline (H, W) of areas, except where they continue as a line."""
    inner = cv2.erode(thick.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    onto = cv2.dilate((inked & ~thick).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return thick & ~inner & ~onto
