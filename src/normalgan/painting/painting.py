"""Painting: from a prepared drawing through the model, and back to the drawing's size and place."""

from dataclasses import dataclass

import cv2
import numpy as np

from normalgan.errors import InputError
from normalgan.normals import Floats
from normalgan.painting.extension import extend
from normalgan.painting.picture import resize
from normalgan.painting.preparation import Mark, Prepared
from normalgan.painting.session import Model
from normalgan.painting.upsampling import sharpen
from normalgan.painting.vectors import lengths, unit

_PRESENT = 0.6
"""Share of the mask in which the model should see the object."""
_LEAST = 0.02
"""Painted vectors that are shorter have no direction."""
_ENLARGED = 1.2
"""How much larger than the model's a map must be to be sharpened."""
_CLOSED = 0.8
"""Share of the ink that must enclose something for the outline to be believed."""

_STRAIGHT = (
    "its outline has a wide gap, which was closed by a straight line; "
    "draw on there, or give --mask, if the object goes on"
)


@dataclass(frozen=True)
class Painted:
    """A normal map and what came with it.

    Args:
        normals: (H, W, 3), unit; off the object they are those on it, smoothly continued.
        mask: (H, W), the object.
        alpha: (H, W) in [0, 1], the drawing's own opacity if that tells the mask, else the mask.
        seen: (S, S), what the model was shown.
        confidence: (H, W), the model's confidence κ, if it has one.
        warning: what went wrong, a part of a sentence; empty if nothing did.
    """

    normals: Floats
    mask: Mark
    alpha: Floats
    seen: Floats
    confidence: Floats | None
    warning: str


def finish(prepared: Prepared, painted: Floats, confidence: Floats | None) -> Painted:
    """Bring what the model painted back to the drawing's size and place, and hold it to the mask.

    Args:
        prepared: as `prepare` gives it.
        painted: (S, S, 3), vectors as long as an object is probable.
        confidence: (S, S), or None.

    Raises:
        InputError: if the model sees no object.
    """
    frame = prepared.frame
    length = lengths(painted)
    present = frame.restore(length[..., None]).reshape(prepared.ink.shape) > 0.5
    mask, warning = _choose(prepared, present)
    painted_share = float((mask & present).sum() / max(int(mask.sum()), 1))
    if painted_share < _PRESENT:
        warning += "; " if warning else ""
        warning += (
            f"the model takes only {painted_share:.0%} of its mask for an object and is unsure of the rest"
        )
    needed = frame.shrink(mask.astype(np.float32)) > 0
    known = _known(length, needed)
    if not known.any():
        raise InputError("the model sees no object in it; draw its outline, or crop other things away.")
    if not mask.any():
        raise InputError("its mask is empty; paint the object white.")
    normals = frame.restore(extend(unit(painted), known, needed))
    if frame.side > _ENLARGED * frame.size:
        _sharpen(normals, known, mask, prepared)
    shown = None
    if confidence is not None:
        shown = frame.restore(confidence[..., None]).reshape(mask.shape)
    if prepared.shape != mask.shape:
        normals, mask = resize(normals, prepared.shape), resize(mask.astype(np.float32), prepared.shape) > 0.5
        shown = None if shown is None else resize(shown, prepared.shape)
    normals = unit(normals, front=True)  # some have none: between opposite ones, and beyond the frame
    alpha = mask.astype(np.float32) if prepared.alpha is None else resize(prepared.alpha, prepared.shape)
    return Painted(normals, mask, np.clip(alpha, 0, 1), prepared.seen, shown, warning)


def _sharpen(normals: Floats, known: Mark, mask: Mark, prepared: Prepared) -> None:
    """Make enlarged normals (h, w, 3) change at the lines again, in place.

    Args:
        normals: brought back from the model's size.
        known: (S, S), where the model painted a direction.
        mask: (h, w), the object, not empty.
        prepared: the drawing.
    """
    frame = prepared.frame
    # A line darkens a pixel of the model on either side.
    around = cv2.dilate(prepared.seen, np.ones((3, 3), np.uint8))
    trusted = (1 - np.minimum(2 * around, 1)) * known
    weight = frame.restore(trusted[..., None].astype(np.float32)).reshape(mask.shape)
    rows, columns = (np.flatnonzero(mask.any(axis)) for axis in (1, 0))
    scale = frame.side / frame.size
    beside = int(np.ceil(2 * scale))  # so that the contour is seen to be one
    top, left = max(rows[0] - beside, 0), max(columns[0] - beside, 0)
    box = np.s_[top : rows[-1] + 1 + beside, left : columns[-1] + 1 + beside]
    normals[box] = sharpen(normals[box], weight[box], prepared.ink[box], mask[box], scale)


def _known(length: Floats, needed: Mark) -> Mark:
    """Return where painted vectors (S, S) have a direction worth keeping.

    Where there is an object for certain, the model's doubt of it, a short vector, is no doubt of the
    direction: what is short beside most of the others is left out there.
    """
    known: Mark = length > 0.5
    if needed.any():
        usual = float(np.percentile(length[needed], 95))
        known |= needed & (length > max(0.1 * usual, _LEAST))
    return known


def paint(model: Model, prepared: Prepared) -> Painted:
    """Paint the normal map of a prepared drawing.

    Raises:
        InputError: if the model sees no object.
    """
    return finish(prepared, *model.paint(prepared.seen, prepared.hints))


def _choose(prepared: Prepared, present: Mark) -> tuple[Mark, str]:
    """Return the object's mask, and what is to be said of it."""
    if prepared.mask is None:
        return present, ""
    if prepared.closed >= _CLOSED:
        return prepared.mask, _STRAIGHT if prepared.guessed else ""
    return prepared.mask | present, (
        f"its outline is not closed, only {prepared.closed:.0%} of its lines enclose anything; where they do "
        "not, the mask is the model's guess (close the gaps, or give --mask)"
    )
