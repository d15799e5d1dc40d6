"""Painting: from a picture to its normal map, through the model and back to the picture's size and place."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.errors import InputError
from normalgan.framing import Frame
from normalgan.inference.cleaning import Cleaned, clean
from normalgan.inference.extension import extend
from normalgan.inference.hint_files import Hints
from normalgan.inference.jobs import MODEL
from normalgan.inference.line_width import show
from normalgan.inference.outline_mask import fill_outline
from normalgan.inference.picture import MOST_WORKED, Picture, fitted, resize
from normalgan.inference.session import Model
from normalgan.inference.upsampling import sharpen
from normalgan.normals import Floats, normalize

Mark = NDArray[np.bool_]
_PRESENT = 0.6
"""Share of the mask in which the model should see the object."""
_LEAST = 0.02
"""Painted vectors that are shorter have no direction."""
_CLOSED = 0.8
"""Share of the ink that must enclose something for the outline to be believed."""


@dataclass(frozen=True)
class Prepared:
    """A drawing as far as it gets without the model.

    Args:
        shape: (H, W) of the map to be.
        ink: (h, w), the drawing's lines, at the size it is worked on.
        mask: (h, w), the object as its opacity, a mask or the outline tells; None leaves it to the model.
        alpha: the drawing's opacity (any H, W), if it tells the mask.
        frame: the square the model is shown.
        seen: (S, S), what it is shown.
        hints: (4, S, S), or None.
        closed: share of the ink that encloses something, if the mask comes from filling the outline; else 1.
    """

    shape: tuple[int, int]
    ink: Floats
    mask: Mark | None
    alpha: Floats | None
    frame: Frame
    seen: Floats
    hints: Floats | None
    closed: float


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


def prepare(
    picture: Picture,
    size: int,
    mask: Mark | None = None,
    hints: Hints | None = None,
    longest: int | None = None,
    source: str | None = None,
) -> Prepared:
    """Clean and frame a picture.

    Args:
        picture: the drawing.
        size: side of the model's pictures.
        mask: (H, W) of the drawing, the object; None takes the drawing's opacity or fills its outline.
        hints: in pixels of the drawing.
        longest: longer side of the map in pixels; None keeps the drawing's own size.
        source: where the mask comes from if it is not given: `OUTLINE`, `MODEL`, or None for the drawing's
            opacity if that tells, else its outline.

    Raises:
        InputError: if there is no line in it.
    """
    shape = picture.shape if longest is None else fitted(picture.shape, longest)
    worked = shape if max(shape) <= MOST_WORKED else fitted(shape, MOST_WORKED)
    cleaned: Cleaned = clean(picture.resized(worked))
    frame = Frame.around(cleaned.ink, size)
    given = None
    if hints is not None:
        given = frame.cut_points(hints.points * (worked[1] / picture.shape[1]), hints.normals)
    alpha, closed = None, 1.0
    if mask is not None:
        mask = resize(mask.astype(np.float32), worked) > 0.5
    elif source is None and cleaned.silhouette is not None:
        mask, alpha = cleaned.silhouette, picture.alpha
    elif source != MODEL:
        outline = fill_outline(cleaned.ink)
        mask, closed = outline.mask, outline.closed
    return Prepared(shape, cleaned.ink, mask, alpha, frame, show(cleaned.ink, frame), given, closed)


def finish(prepared: Prepared, painted: Floats, confidence: Floats | None) -> Painted:
    """Bring what the model painted back to the drawing's size and place, and hold it to the mask.

    Args:
        prepared: as `prepare` gives it.
        painted: (S, S, 3), vectors as long as an object is probable.
        confidence: (S, S), or None.

    Raises:
        InputError: if the model sees no object.
    """
    frame, seen = prepared.frame, prepared.seen
    length = np.linalg.norm(painted, axis=-1)
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
    vectors = extend(normalize(painted), known, needed)
    normals = frame.restore(vectors)
    scale = frame.side / frame.size
    if scale > 1.2:
        # A line darkens a pixel of the model on either side.
        trusted = 1 - np.minimum(2 * _around(seen), 1)
        weight = frame.restore((trusted * known)[..., None].astype(np.float32)).reshape(mask.shape)
        rows, columns = (np.flatnonzero(mask.any(axis)) for axis in (1, 0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        normals[box] = sharpen(normals[box], weight[box], prepared.ink[box], mask[box], scale)
    shown = None
    if confidence is not None:
        shown = frame.restore(confidence[..., None]).reshape(mask.shape)
    if prepared.shape != mask.shape:
        normals, mask = resize(normals, prepared.shape), resize(mask.astype(np.float32), prepared.shape) > 0.5
        shown = None if shown is None else resize(shown, prepared.shape)
    normals = normalize(normals)
    cancelled = np.abs(normals).sum(-1, keepdims=True) == 0  # between opposite ones, and beyond the frame
    normals = np.where(cancelled, np.array([0, 0, 1], np.float32), normals)
    alpha = mask.astype(np.float32) if prepared.alpha is None else resize(prepared.alpha, prepared.shape)
    return Painted(normals, mask, np.clip(alpha, 0, 1), seen, shown, warning)


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
        return prepared.mask, ""
    return prepared.mask | present, (
        f"its outline is not closed, only {prepared.closed:.0%} of its lines enclose anything; where they do "
        "not, the mask is the model's guess (close the gaps, or give --mask)"
    )


def _around(seen: Floats) -> Floats:
    """Return ink that has spread to the pixels next to it."""
    return np.asarray(cv2.dilate(seen, np.ones((3, 3), np.uint8)), np.float32)
