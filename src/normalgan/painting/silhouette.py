"""Silhouette: what a drawing's transparency says: the object's outline, or only where there is ink."""

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.normals import Floats


def is_silhouette(alpha: Floats) -> bool:
    """Return whether what is opaque (H, W) is an object and not just its lines.

    Lines enclose far more than they cover; an object covers what it encloses.

    >>> ring = np.zeros((32, 32), np.float32)
    >>> ring[4:28, 4:28] = 1
    >>> disc = ring.copy()
    >>> ring[6:26, 6:26] = 0
    >>> is_silhouette(disc), is_silhouette(ring)
    (True, False)
    """
    opaque = alpha > 0.5
    if opaque.mean() > 0.995:  # rounded corners, a torn edge: the sheet and no object
        return False
    covered, enclosed = int(opaque.sum()), int(enclosed_by(opaque).sum())
    if covered < 0.7 * enclosed:
        return False
    # Open lines enclose nothing but themselves; nowhere are they as thick as an object.
    depth = cv2.distanceTransform(np.pad(opaque, 1).astype(np.uint8), cv2.DIST_L2, 3)
    return float(depth.max()) > 0.04 * _extent(opaque)


def enclosed_by(barrier: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the barrier (H, W) and all that cannot be reached past it from the picture's edge."""
    reached = np.pad(barrier, 1).astype(np.uint8)
    cv2.floodFill(reached, None, (0, 0), 2, flags=4)
    inside: NDArray[np.bool_] = reached[1:-1, 1:-1] != 2
    return inside


def over_own_colour(colour: Floats, alpha: Floats) -> Floats:
    """Return colours (H, W, 3) laid over that of most of the object, so that only its lines differ."""
    own = np.median(colour[alpha > 0.5], axis=0)
    return np.asarray(colour * alpha[..., None] + own * (1 - alpha[..., None]), np.float32)


def contour(silhouette: NDArray[np.bool_]) -> Floats:
    """Return a line just inside a silhouette (H, W), about a 250th of its extent wide, ink 1."""
    width = max(_extent(silhouette) / 250, 1.5)
    depth = cv2.distanceTransform(np.pad(silhouette, 1).astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    return np.where(silhouette, np.clip(width + 0.5 - depth, 0, 1), 0).astype(np.float32)


def _extent(inked: NDArray[np.bool_]) -> int:
    rows, columns = np.flatnonzero(inked.any(1)), np.flatnonzero(inked.any(0))
    return int(max(np.ptp(rows), np.ptp(columns))) + 1 if len(rows) else 1
