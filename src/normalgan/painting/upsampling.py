"""Upsampling: a map of the model's size at the drawing's, with its edges on the drawing's lines."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.normals import Floats
from normalgan.painting.extension import extend
from normalgan.painting.gathering import spread
from normalgan.painting.preparation import Prepared

__all__ = ["Coarse", "Mark", "Upsampler", "fill_and_sharpen", "sharpen"]

_BARRIER = 6.0
"""What crossing a line costs, in reaches."""
_FINEST = 3.0
"""At most as many pixels for each of the model are worked on; only what lies on lines needs more."""
_INK = 0.35
_ENLARGED = 1.2
"""How much larger than the model's a map must be to be sharpened."""
Mark = NDArray[np.bool_]


@dataclass(frozen=True)
class Coarse:
    """What the network painted, at its own size.

    Args:
        normals: (S, S, 3), unit; zero where the network painted nothing.
        known: (S, S), where they are to be kept; True somewhere.
        needed: (S, S), where the object is.
    """

    normals: Floats
    known: Mark
    needed: Mark


class Upsampler(Protocol):
    """The step from the network's size to the drawing's. Another one is handed to `pipeline.paint`."""

    def __call__(self, coarse: Coarse, prepared: Prepared, mask: Mark) -> Floats:
        """Return normals (h, w, 3) at the size and place of ``prepared.ink``, of any length.

        Args:
            coarse: what was painted in the square ``prepared.frame``.
            prepared: the drawing: its lines (h, w), its frame, what the network was shown.
            mask: (h, w), the object, not empty. Off it normals matter only for what blends across its edge.
        """
        ...


def fill_and_sharpen(coarse: Coarse, prepared: Prepared, mask: Mark) -> Floats:
    """Fill what was not painted, enlarge, and let normals change at the drawing's lines; an `Upsampler`."""
    frame = prepared.frame
    normals = frame.restore(extend(coarse.normals, coarse.known, coarse.needed))
    if frame.side <= _ENLARGED * frame.size:
        return normals
    # A line darkens a pixel of the model on either side.
    around = cv2.dilate(prepared.seen, np.ones((3, 3), np.uint8))
    trusted = (1 - np.minimum(2 * around, 1)) * coarse.known
    weight = frame.restore(trusted[..., None].astype(np.float32)).reshape(mask.shape)
    rows, columns = (np.flatnonzero(mask.any(axis)) for axis in (1, 0))
    scale = frame.side / frame.size
    beside = int(np.ceil(2 * scale))  # so that the contour is seen to be one
    top, left = max(rows[0] - beside, 0), max(columns[0] - beside, 0)
    box = np.s_[top : rows[-1] + 1 + beside, left : columns[-1] + 1 + beside]
    normals[box] = sharpen(normals[box], weight[box], prepared.ink[box], mask[box], scale)
    return normals


def sharpen(values: Floats, weight: Floats, ink: Floats, mask: Mark, scale: float) -> Floats:
    """Return enlarged values that do not blend across lines, (H, W, C).

    Enlarging blends both sides of a line over some pixels of the model. Here each pixel, as far as its own
    value is not to be trusted, gathers those about it by weight, and those on the far side of a line hardly
    count. Of a large drawing this is done at a lower size; there a line is some pixels wide, and in its
    middle each pixel then takes the value of the nearest one beside it.

    Args:
        values: (H, W, C), enlarged by interpolation.
        weight: (H, W) in [0, 1], how far each is to be trusted: little near lines.
        ink: (H, W), the drawing's lines.
        mask: (H, W), the object.
        scale: pixels of the drawing for each of the model.
    """
    factor = min(_FINEST / scale, 1)
    if factor == 1:
        return _gathered(values, weight, ink, mask, scale)
    shape = (max(round(mask.shape[0] * factor), 1), max(round(mask.shape[1] * factor), 1))

    def smaller(picture: Floats) -> Floats:
        return np.asarray(cv2.resize(picture, shape[::-1], interpolation=cv2.INTER_AREA), np.float32)

    # A line thinner than a pixel must not get lost.
    thick = np.asarray(cv2.dilate(ink, np.ones((3, 3), np.uint8)), np.float32)
    inside = smaller(mask.astype(np.float32)) > 0.5
    if not inside.any():
        return values
    small = _gathered(smaller(values), smaller(weight), smaller(thick), inside, _FINEST)
    size = mask.shape[::-1]
    enlarged = np.asarray(cv2.resize(small, size, interpolation=cv2.INTER_LINEAR), np.float32)
    enlarged += (weight * weight)[..., None] * (values - enlarged)
    return _parted(enlarged, ink, mask, 1.5 / factor)


def _gathered(values: Floats, weight: Floats, ink: Floats, mask: Mark, reach: float) -> Floats:
    """Return values (H, W, C) gathered over about ``reach`` pixels, where their own weight is low."""
    trusted = (weight * weight * mask)[..., None]
    weight = np.where(mask, weight + np.float32(1e-3), np.float32(1e-6))
    carried = np.empty((values.shape[-1] + 1, *mask.shape), np.float32)
    np.multiply(np.moveaxis(values, -1, 0), weight, out=carried[:-1])
    carried[-1] = weight
    *gathered, total = spread(carried, np.float32(_BARRIER * reach) * _middles(ink, mask), reach)
    there = cv2.merge([each / total for each in gathered])
    return np.asarray(there + trusted * (values - there), np.float32)


def _parted(values: Floats, ink: Floats, mask: Mark, reach: float) -> Floats:
    """Return values (H, W, C) that change at once in the middle of lines, not over ``reach`` pixels."""
    blended = cv2.dilate((_middles(ink, mask) > 0.5).astype(np.uint8), _disc(reach)) > 0
    sources = np.flatnonzero(mask & ~blended)
    if not len(sources):
        return values
    beside = np.ones(mask.shape, np.uint8)
    beside.ravel()[sources] = 0
    _, labels = cv2.distanceTransformWithLabels(beside, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    # Each source has a label of its own, which all that are nearest to it share.
    place = np.zeros(len(sources) + 1, np.intp)
    place[labels.ravel()[sources]] = sources
    wanted = np.flatnonzero(mask & blended)
    out = values.copy()
    flat = out.reshape(-1, values.shape[-1])
    flat[wanted] = flat[place[labels.ravel()[wanted]]]
    return out


def _middles(ink: Floats, mask: Mark) -> Floats:
    """Return 1 along the middle of lines and next to nothing at their edges, (H, W).

    The object's contour is left out: beyond it there is nothing, and its outer half belongs to the inner.
    """
    inked = (ink > _INK).astype(np.uint8)
    depth = cv2.distanceTransform(np.pad(inked, 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    size = 2 * int(np.ceil(np.median(depth[inked > 0]))) + 1 if inked.any() else 3
    deepest = cv2.dilate(depth, np.ones((size, size), np.uint8))
    inner = cv2.erode(mask.astype(np.uint8), np.ones((2 * size + 1,) * 2, np.uint8), borderValue=1)
    return np.asarray((depth / np.maximum(deepest, 1)) ** 4 * inner, np.float32)


def _disc(radius: float) -> NDArray[np.uint8]:
    side = 2 * int(np.ceil(radius)) + 1
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)), np.uint8)
