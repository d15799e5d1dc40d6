"""Stroke ends: where the lines of a drawing stop, and the way in which they would go on."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats

__all__ = ["Ends", "stroke_ends"]


@dataclass(frozen=True)
class Ends:
    """Where lines stop.

    Args:
        points: (K, 2), x right and y down in whole pixels.
        ways: (K, 2), unit vectors out of the lines.
        width: of most lines in pixels.
    """

    points: Floats
    ways: Floats
    width: float

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.points)

    def only(self, wanted: BoolMask) -> "Ends":
        """Return those for which ``wanted``, (K,), is true."""
        return Ends(self.points[wanted], self.ways[wanted], self.width)


def stroke_ends(inked: BoolMask, width: float) -> Ends:
    """Return where the lines of a drawing (H, W) stop.

    About a pixel on a line a ring crosses ink twice, about one near an end once, and on a short arc; near
    another line it crosses that too, and there is no gap worth the name. Of the pixels about an end the
    foremost is taken. Thinning would tell as well, but grows hairs on rough lines, of which each has an end.

    Args:
        inked: (H, W).
        width: of most lines in pixels.
    """
    across, down = _ring(1.5 * width + 2)
    margin = int(across.max())
    padded = np.pad(inked, margin)
    rows, columns = np.nonzero(padded)
    # One index instead of two: this is most of the time that is spent here.
    stride = padded.shape[1]
    ring = padded.ravel().take((rows * stride + columns)[:, None] + (down * stride + across))
    arcs = (ring[:, 1:] > ring[:, :-1]).sum(1) + (ring[:, 0] > ring[:, -1])
    share = ring.sum(1)
    at_end = (arcs == 1) & (share <= len(across) / 3)
    if not at_end.any():
        return Ends(np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32), width)
    rows, columns, ring, share = rows[at_end], columns[at_end], ring[at_end], share[at_end]
    mark = np.zeros(padded.shape, np.uint8)
    mark[rows, columns] = 1
    count, labels = cv2.connectedComponents(mark, connectivity=8)
    own = labels[rows, columns] - 1
    back = ring @ np.stack([across, down], axis=1).astype(np.float32) / share[:, None]
    ways = -np.stack([np.bincount(own, back[:, axis], count - 1) for axis in (0, 1)], axis=1)
    ways = ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-6)
    pixels = np.stack([columns, rows], axis=1)
    order = np.lexsort(((pixels * ways[own]).sum(1), own))
    last = np.flatnonzero(np.diff(own[order], append=count))
    tips = pixels[order][last] - margin
    return Ends(tips.astype(np.float32), ways.astype(np.float32), width)


def _ring(radius: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return all pixels that a circle passes, in their order: how far across they are, and how far down.

    No line slips through between them, not even one that hangs together by its pixels' corners.
    """
    angles = np.arange(0, 2 * np.pi, 0.01 / radius)
    pixels = np.rint(radius * np.stack([np.cos(angles), np.sin(angles)])).astype(np.intp)
    others = (pixels != np.roll(pixels, 1, axis=1)).any(0)
    across, down = pixels[:, others]
    return across, down
