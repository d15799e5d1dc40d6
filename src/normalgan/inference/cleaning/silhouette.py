"""Silhouette: decide whether a drawing's opacity shows the whole object or only its ink."""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.cleaning.reader import Reading, read, reduced
from normalgan.inference.reading.picture import Picture
from normalgan.inference.regions import around, depth_of, extent_of

_SHEET = 0.995
"""Opaque fraction of a picture above which it is paper with rounded corners or a torn edge, and of the opaque
part's bounding box above which that part is a rectangle."""
_SURE = 0.05
"""Margin by which ink must exceed coverage for the opaque part to be lines; a black shape has ink near 1."""
_HELD = 0.7
"""Minimum fraction of an opaque rectangle that belongs to the object; otherwise the object is drawn on it.
The reader finds at least 0.9 of nearly all boxes, and line drawings cover at most 0.5 of their card."""
_TRANSLUCENT = 0.05
"""Minimum opacity of most pixels in an enclosed area that belongs to the object, such as a bottle's glass.
The pixels at the edge of a hole are also translucent."""
_TINY = 24
"""Longer side of an object in drawn pixels, below which its own outline, one pixel wide, would count as an
area. Such an area gets an inner and an outer edge, and the object becomes a ring. A smaller rectangle has no
room for a drawing."""
_RIM = 1.75
"""Width of a tiny object's own outline in drawn pixels, measured across pixels that meet at their corners."""


def is_silhouette(picture: Picture, reading: Reading | None = None, drawn_pixel: float = 1.0) -> bool:
    """Return whether the opaque part is an object and not just its lines, according to the reader.

    If the opaque part is an object, it covers nearly all of the object and is only partly ink. If it is
    lines, it is nearly all ink and covers only part of the object. If it is a card, it is a rectangle, and
    the object covers only part of it. ``tools/reader/measure.py --pages`` found this right for 351 of 360
    pictures that were drawn from meshes.

    Args:
        picture: the drawing.
        reading: the reader's output for the drawing; None runs the reader.
        drawn_pixel: side of the original drawing's pixels in pixels of ``picture``.
    """
    colour, alpha = picture.colour, picture.alpha
    if alpha is None:
        return False
    opaque = opaque_part(alpha)
    if not opaque.any() or (opaque.mean() > _SHEET and not picture.cut_out):
        return False
    extent = extent_of(opaque)
    room = extent // 8 + 2
    within = around(opaque, 0)
    rectangle = extent >= _TINY * drawn_pixel and bool(opaque[within].mean() > _SHEET)
    if rectangle:
        # Without room around it, a box looks like paper.
        sides = (room, room), (room, room)
        colour, alpha = np.pad(colour[within], (*sides, (0, 0))), np.pad(alpha[within], sides)
        reading = read(Picture(colour, alpha))
    elif reading is None or extent < max(opaque.shape) / 2:
        # At page scale a small figure has too few pixels for the reader.
        box = around(opaque, room)
        colour, alpha = np.ascontiguousarray(colour[box]), np.ascontiguousarray(alpha[box])
        reading = read(Picture(colour, alpha))
    alpha = reduced(alpha, (reading.ink.shape[0], reading.ink.shape[1]))
    present = reading.presence > 0.5
    inked = float((reading.ink * alpha).sum() / alpha.sum())
    both = float((present * alpha).sum())
    covered = both / max(int(present.sum()), 1)
    return inked <= covered + _SURE and (not rectangle or both > _HELD * float(alpha.sum()))


def opaque_part(alpha: Floats) -> BoolMask:
    """Return the opaque part (H, W) of a drawing, with the translucent areas that it encloses.

    Args:
        alpha: (H, W), opacity.
    """
    opaque = alpha > 0.5
    count, found = cv2.connectedComponents((~opaque).view(np.uint8), connectivity=4)
    labels = np.asarray(found, np.int32)
    sizes = np.bincount(labels.ravel(), minlength=count)
    belongs = np.bincount(labels.ravel(), (alpha >= _TRANSLUCENT).ravel(), count) > sizes / 2
    belongs[np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])] = False
    belongs[0] = False
    return opaque | np.take(belongs, labels)


def outlined(ink: Floats, silhouette: BoolMask, drawn_pixel: float = 1.0) -> Floats:
    """Return the ink (H, W) of an object with a line along its silhouette.

    The line is added to the object's own outline. In a tiny object, such as 16 × 16 pixel art, it replaces
    the outline, unless the object is nothing but outline.

    Args:
        ink: (H, W) in [0, 1], the ink of the drawing.
        silhouette: (H, W), the object.
        drawn_pixel: side of the original drawing's pixels in pixels of ``ink``.
    """
    own = np.where(silhouette, ink, 0).astype(np.float32)
    inside = depth_of(silhouette) >= _RIM * drawn_pixel
    if extent_of(silhouette) < _TINY * drawn_pixel and inside.any():
        return np.where(inside, own, contour(silhouette, drawn_pixel / 2))
    return np.maximum(own, contour(silhouette, drawn_pixel))


def contour(silhouette: BoolMask, drawn_pixel: float = 1.0) -> Floats:
    """Return the ink (H, W) of a line just inside a silhouette, about 1/250 of its extent wide.

    Args:
        silhouette: (H, W), the object.
        drawn_pixel: side of the original drawing's pixels in pixels of ``silhouette``. The line covers the
            half-transparent pixels at the edge; otherwise a gap would part it from the object's own outline.
    """
    width = max(extent_of(silhouette) / 250, 1.5 * drawn_pixel)
    return np.where(silhouette, np.clip(width + 0.5 - depth_of(silhouette), 0, 1), 0).astype(np.float32)
