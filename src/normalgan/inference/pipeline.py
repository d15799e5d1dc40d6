"""Pipeline: predict the map of a prepared drawing.

A drawing is read (`picture`, `inputs`), cleaned, masked and framed (`preparation`), predicted by a `Backend`,
mapped back to its own size and position (`upsampling`), and written (`outputs`).
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

_PRESENT = 0.6
"""Minimum fraction of the mask in which the model should see the object; less gives a warning."""
_LEAST = 0.02
"""Minimum length of a predicted vector whose direction is used."""

_BESIDE = 0.005
"""Maximum distance of a hint from the mask, whose edge is a guess, as a fraction of the longer side."""


def predict(backend: Backend, prepared: Prepared, upsample: Upsampler | None = None) -> NormalMap:
    """Return the normal map of a prepared drawing; ``upsample`` replaces the network's own upsampler.

    Raises:
        LackingError: if the network sees no object.
    """
    preds, confidence = backend.predict(prepared.model_input, prepared.hints)
    return finish(prepared, preds, confidence, upsample or backend.upsample)


def finish(prepared: Prepared, preds: Floats, confidence: Floats | None, upsample: Upsampler) -> NormalMap:
    """Map a prediction back to the drawing's size and position, and apply the mask and the pins.

    Args:
        prepared: the prepared drawing, from `prepare`.
        preds: (S, S, 3), vectors whose length is the probability of an object.
        confidence: (S, S), or None.
        upsample: enlarges the prediction to the drawing's size.

    Raises:
        LackingError: if the model sees no object, or the mask is empty.
    """
    frame = prepared.frame
    length = lengths(preds)
    present = frame.restore(length[..., None]).reshape(prepared.ink.shape) > 0.5
    mask, findings = _choose(prepared, present)
    seen_share = int(np.count_nonzero(mask & present)) / max(int(np.count_nonzero(mask)), 1)
    if seen_share < _PRESENT:
        findings += (Finding("unseen", share=seen_share),)
    coarse = coarse_of(prepared, preds, mask, length)
    if not coarse.known.any():
        raise LackingError(
            "the model sees no object in it; draw its outline, or crop other things away.", "no_object"
        )
    if not mask.any():
        raise LackingError("its mask is empty; paint the object white.", "empty_mask")
    normals = upsample(coarse, prepared, mask)
    covered = _covered(prepared, mask)
    if confidence is not None:
        confidence = frame.restore(confidence[..., None]).reshape(mask.shape)
    enlarged = prepared.shape != mask.shape
    if enlarged:
        covered = _enlarged(covered, prepared.shape)
        mask = covered > 0.5
        normals = resize(normals, prepared.shape)
        confidence = None if confidence is None else resize(confidence, prepared.shape)
    # A visible surface does not face away from the viewer, but normals extended off the object may.
    np.maximum(normals[..., 2], 0, out=normals[..., 2])
    # Vectors between opposite normals and outside the frame may be zero.
    normals = unit(normals, front=True, out=normals)
    pins = prepared.map_hints
    if pins is not None and 0 < len(pins.points) <= MOST_PINS:
        reaches = np.full(len(pins.points), REACH * max(prepared.shape), np.float32)
        normals = enforce_pins(normals, pins.points, pins.normals, reaches)
    if pins is not None and prepared.drawing_hints is not None:
        findings += hints_off(prepared.drawing_hints.points, pins.points, mask)
    return NormalMap(normals, mask, _opacity(prepared, covered), prepared.model_input, confidence, findings)


def hints_off(drawn: Floats, points: Floats, mask: BoolMask) -> tuple[Finding, ...]:
    """Return the finding about hints off the object; empty if there are none.

    Args:
        drawn: (K, 2), positions of the hints in pixels of the drawing.
        points: (K, 2), positions of the hints in pixels of the mask.
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

    Where the mask still follows the outline, the coverage comes from the ink. Elsewhere the edge is one pixel
    wide.

    Args:
        prepared: the prepared drawing, from `prepare`.
        mask: (h, w), the object after the user's edits.
    """
    if prepared.coverage is None:
        return soft_edge(mask)
    changed = mask != (prepared.coverage > 0.5)
    if not changed.any():
        return prepared.coverage
    near = cv2.dilate(changed.view(np.uint8), np.ones((5, 5), np.uint8)) > 0
    return np.where(near, soft_edge(mask), prepared.coverage)


def _opacity(prepared: Prepared, covered: Floats) -> Floats:
    """Return a map's opacity (H, W): the drawing's alpha outside the user's edits, otherwise the coverage."""
    edge: Floats = (np.rint(covered * 255) / 255).astype(np.float32)
    if prepared.alpha is None:
        return edge
    alpha = np.clip(resize(prepared.alpha, prepared.shape), 0, 1)
    if prepared.painted is None:
        return alpha
    by_hand = cv2.resize(prepared.painted, prepared.shape[::-1], interpolation=cv2.INTER_NEAREST)
    return np.where(by_hand == 0, alpha, edge).astype(np.float32)


def _enlarged(covered: Floats, shape: tuple[int, int]) -> Floats:
    """Return coverage enlarged to (H, W), with edges sharpened to a width of one pixel."""
    edge = resize(covered, shape)
    sharper = np.float32(max(shape[1] / covered.shape[1], 1))
    for strip in strips(shape):
        steep = edge[strip]  # in place, because copies would take longer than the arithmetic
        steep -= 0.5
        steep *= sharper
        steep += 0.5
        np.clip(steep, 0, 1, out=steep)
    return edge


def coarse_of(prepared: Prepared, preds: Floats, mask: BoolMask, length: Floats | None = None) -> Coarse:
    """Return the network's prediction and the mask of reliable normals.

    Off the mask, a normal is reliable if the network sees an object there. Inside the mask, a short vector
    only means that the network doubts the presence of an object, so only vectors much shorter than most
    others are dropped.

    Args:
        prepared: the prepared drawing, from `prepare`.
        preds: (S, S, 3), vectors whose length is the probability of an object.
        mask: (h, w), the object at the size of ``prepared.ink``.
        length: (S, S), lengths of ``preds``, if already computed.
    """
    length = lengths(preds) if length is None else length
    needed = prepared.frame.shrink(mask.astype(np.float32)) > 0
    known: BoolMask = length > 0.5
    if needed.any():
        usual = ranked(length[needed], 0.95)
        known |= needed & (length > max(0.1 * usual, _LEAST))
    return Coarse(unit(preds, length=length), known, needed)


def _choose(prepared: Prepared, present: BoolMask) -> tuple[BoolMask, tuple[Finding, ...]]:
    """Return the object's mask after the user's edits, and the findings about it."""
    mask = present if prepared.mask is None else prepared.mask
    if prepared.painted is None:
        return mask, prepared.unsure
    added = prepared.painted > 0
    mask = mask | added
    if added.any():
        mask |= _gaps(prepared.ink, mask, added)
    # The user has checked the mask, so the findings about it are dropped.
    return mask & (prepared.painted >= 0), ()


def _gaps(ink: Floats, mask: BoolMask, added: BoolMask) -> BoolMask:
    """Return the gaps (h, w) next to areas added by the user that consist of ink only.

    A filled area ends where a line begins, but the object ends where the line is half dark. The pixels
    between the two would be holes in the object.

    Args:
        ink: (h, w) in [0, 1].
        mask: (h, w), the object including the added areas.
        added: (h, w), the added areas.
    """
    count, parts = cv2.connectedComponents((~mask).view(np.uint8), connectivity=4)
    gap = np.zeros(count, np.bool_)
    beside = cv2.dilate(added.view(np.uint8), np.ones((3, 3), np.uint8)) > 0
    gap[parts[beside & ~mask]] = True
    gap[parts[ink == 0]] = False
    return np.asarray(gap[parts], np.bool_)
