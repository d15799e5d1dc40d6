"""Pipeline: from a prepared drawing to its map, for every caller and every network.

A drawing is read (`picture`, `inputs`), cleaned, masked and framed (`preparation`), predicted by a `Backend`,
brought to its own size (`upsampling`) and place, and written (`outputs`).
"""

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.inference.edits import MOST_PINS, REACH, enforce_pins
from normalgan.inference.findings import Finding, LackingError
from normalgan.inference.mask.edge import soft_edge
from normalgan.inference.medians import ranked
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.upsampling import Coarse, Upsampler
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.picture import resize
from normalgan.inference.vectors import lengths, unit
from normalgan.normals import strips

__all__ = ["coarse_of", "finish", "hints_off", "predict"]

_PRESENT = 0.6
"""Share of the mask in which the model should see the object."""
_LEAST = 0.02
"""Predicted vectors that are shorter have no direction."""

_BESIDE = 0.005
"""How far beside the mask a hint may lie, as a share of the longer side, because the edge is a guess."""


def finish(prepared: Prepared, preds: Floats, confidence: Floats | None, upsample: Upsampler) -> NormalMap:
    """Bring the prediction back to the drawing's size and place, and apply the mask and the pins.

    Args:
        prepared: as `prepare` gives it.
        preds: (S, S, 3), vectors whose length is the probability of an object.
        confidence: (S, S), or None.
        upsample: the step to the drawing's size.

    Raises:
        LackingError: if the model sees no object, or nothing is left of it.
    """
    frame = prepared.frame
    length = lengths(preds)
    present = frame.restore(length[..., None]).reshape(prepared.ink.shape) > 0.5
    mask, findings = _choose(prepared, present)
    painted_share = int(np.count_nonzero(mask & present)) / max(int(np.count_nonzero(mask)), 1)
    if painted_share < _PRESENT:
        findings += (Finding("unseen", share=painted_share),)
    coarse = coarse_of(prepared, preds, mask, length)
    if not coarse.known.any():
        raise LackingError(
            "the model sees no object in it; draw its outline, or crop other things away.", "no_object"
        )
    if not mask.any():
        raise LackingError("its mask is empty; paint the object white.", "empty_mask")
    normals = upsample(coarse, prepared, mask)
    covered = _covered(prepared, mask)
    shown = None
    if confidence is not None:
        shown = frame.restore(confidence[..., None]).reshape(mask.shape)
    enlarged = prepared.shape != mask.shape
    if enlarged:
        covered = _enlarged(covered, prepared.shape)
        mask = covered > 0.5
        normals = resize(normals, prepared.shape)
        shown = None if shown is None else resize(shown, prepared.shape)
    # What is seen does not face away; off the object its normals, continued, would.
    np.maximum(normals[..., 2], 0, out=normals[..., 2])
    # Some have no direction: between opposite ones, and beyond the frame.
    normals = unit(normals, front=True, out=normals if enlarged else None)
    pins = prepared.pins
    if pins is not None and 0 < len(pins.points) <= MOST_PINS:
        reaches = np.full(len(pins.points), REACH * max(prepared.shape), np.float32)
        normals = enforce_pins(normals, pins.points, pins.normals, reaches)
    if pins is not None and prepared.given is not None:
        findings += hints_off(prepared.given.points, pins.points, mask)
    return NormalMap(normals, mask, _opacity(prepared, covered), prepared.seen, shown, findings)


def hints_off(drawn: Floats, points: Floats, mask: BoolMask) -> tuple[Finding, ...]:
    """Return the finding about hints off the object, if there are any.

    Args:
        drawn: (K, 2), where the hints are, in pixels of the drawing.
        points: (K, 2), the same in pixels of the mask.
        mask: (H, W), the object.
    """
    beside = max(round(_BESIDE * max(mask.shape)), 1)
    near = cv2.dilate(mask.astype(np.uint8), np.ones((2 * beside + 1,) * 2, np.uint8))
    columns, rows = np.floor(points).astype(int).T
    inside = near[np.clip(rows, 0, mask.shape[0] - 1), np.clip(columns, 0, mask.shape[1] - 1)]
    off = np.floor(drawn[inside == 0]).astype(int)
    if not len(off):
        return ()
    return (Finding("hints", tuple((float(x), float(y)) for x, y in off), len(off), len(drawn)),)


def _covered(prepared: Prepared, mask: BoolMask) -> Floats:
    """Return the coverage of each pixel (h, w) by the object.

    Where the mask is still the outline's, coverage comes from the ink; elsewhere the edge is one pixel wide.

    Args:
        prepared: as `prepare` gives it.
        mask: (h, w), the object as it is now.
    """
    soft = soft_edge(mask)
    if prepared.coverage is None:
        return soft
    changed = (mask != (prepared.coverage > 0.5)).astype(np.uint8)
    return np.where(cv2.dilate(changed, np.ones((5, 5), np.uint8)) > 0, soft, prepared.coverage)


def _opacity(prepared: Prepared, covered: Floats) -> Floats:
    """Return a map's opacity (H, W): the drawing's if it gives the mask, but for edits; else the coverage."""
    edge: Floats = (np.rint(covered * 255) / 255).astype(np.float32)
    if prepared.alpha is None:
        return edge
    alpha = np.clip(resize(prepared.alpha, prepared.shape), 0, 1)
    if prepared.painted is None:
        return alpha
    by_hand = cv2.resize(prepared.painted, prepared.shape[::-1], interpolation=cv2.INTER_NEAREST)
    return np.where(by_hand == 0, alpha, edge).astype(np.float32)


def _enlarged(covered: Floats, shape: tuple[int, int]) -> Floats:
    """Return coverage at a larger size (H, W), where an edge is a pixel wide again."""
    edge = resize(covered, shape)
    sharper = np.float32(shape[1] / covered.shape[1])
    for strip in strips(shape):
        steep = edge[strip]  # in place: at each step a copy would take longer than the step
        steep -= 0.5
        steep *= sharper
        steep += 0.5
        np.clip(steep, 0, 1, out=steep)
    return edge


def coarse_of(prepared: Prepared, preds: Floats, mask: BoolMask, length: Floats | None = None) -> Coarse:
    """Return the network's prediction, and where its direction is reliable.

    Inside a certain object a short vector means doubt about presence, not direction; only vectors that are
    short compared with most others are left out there.

    Args:
        prepared: as `prepare` gives it.
        preds: (S, S, 3), vectors whose length is the probability of an object.
        mask: (h, w), the object at the size of ``prepared.ink``.
        length: (S, S), their lengths, if known already.
    """
    length = lengths(preds) if length is None else length
    needed = prepared.frame.shrink(mask.astype(np.float32)) > 0
    known: BoolMask = length > 0.5
    if needed.any():
        usual = ranked(length[needed], 0.95)
        known |= needed & (length > max(0.1 * usual, _LEAST))
    return Coarse(unit(preds, length=length), known, needed)


def predict(backend: Backend, prepared: Prepared, upsample: Upsampler | None = None) -> NormalMap:
    """Predict the normal map of a prepared drawing; ``upsample`` replaces the network's own step to its size.

    Raises:
        LackingError: if the network sees no object.
    """
    return finish(prepared, *backend.predict(prepared.seen, prepared.hints), upsample or backend.upsample)


def _choose(prepared: Prepared, present: BoolMask) -> tuple[BoolMask, tuple[Finding, ...]]:
    """Return the object's mask, and the findings about it."""
    mask = present if prepared.mask is None else prepared.mask
    if prepared.painted is None:
        return mask, prepared.unsure
    added = prepared.painted > 0
    mask = mask | added
    if added.any():
        mask |= _gaps(prepared.ink, mask, added)
    # Edits by hand have the last word, so nothing is said about them.
    return mask & (prepared.painted >= 0), ()


def _gaps(ink: Floats, mask: BoolMask, added: BoolMask) -> BoolMask:
    """Return the gaps (h, w) beside what a user has added that are all ink.

    A filled area ends where a line begins, the object where the line is half dark: some pixels of the line's
    edge lie between them, which would be holes with a rim each.

    Args:
        ink: (h, w) in [0, 1].
        mask: (h, w), the object with what was added.
        added: (h, w), what was added.
    """
    count, parts = cv2.connectedComponents((~mask).view(np.uint8), connectivity=4)
    gap = np.zeros(count, np.bool_)
    beside = cv2.dilate(added.view(np.uint8), np.ones((3, 3), np.uint8)) > 0
    gap[parts[beside & ~mask]] = True
    gap[parts[ink == 0]] = False
    return np.asarray(gap[parts], np.bool_)
