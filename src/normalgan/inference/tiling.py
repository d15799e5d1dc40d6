"""Tiling: predict a seamless map of a seamless drawing."""

from dataclasses import replace
from functools import partial
from math import ceil

import cv2
import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.ink import clean
from normalgan.inference.cleaning.reader import read
from normalgan.inference.findings import Finding
from normalgan.inference.forms import Form, give_form
from normalgan.inference.mask.decision import decide
from normalgan.inference.mask.mask_files import MODEL, READER, MaskOrSource
from normalgan.inference.network.backend import Backend
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.network.tile import Tile, middle, repeats, resize_tile, wrapped
from normalgan.inference.network.upsampling import Upsampler
from normalgan.inference.network.windows import Window, predict_windows, repeated, windows
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.pipeline import finish, hints_off
from normalgan.inference.preparation import Prepared
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import MOST_WORKED, Picture, fitted, fitted_within, resize
from normalgan.inference.regions import INKED
from normalgan.inference.vectors import lengths, unit

_BESIDE = 0.25
"""Margin of repeats that is processed around a drawing, as a fraction of its longer side."""
MOST_TILED = int(MOST_WORKED / (1 + 2 * _BESIDE))
"""Maximum longer side in pixels at which a repeating drawing is processed."""
_CLOSED = 0.8
"""Minimum fraction of the ink that must lie in enclosed areas for them to be the object."""
_ALL = 0.9
"""Enclosed fraction of a tile above which the whole tile is object."""
_SURE = 0.5
"""Minimum length of a predicted vector on the object."""
_STEEPEST = 0.2
"""Minimum nz, relative to the vector's length, for computing slopes."""


def predict_tile(
    backend: Backend,
    picture: Picture,
    tile: Tile,
    mask: MaskOrSource = None,
    hints: Hints | None = None,
    longest: int | None = None,
    upsample: Upsampler | None = None,
) -> NormalMap:
    """Return the normal map of a repeating drawing; the map repeats in the same directions.

    The network treats its input as a single round object. The repeated drawing is therefore predicted in
    overlapping windows, weighted towards their centres, so that the edge of one window is at the centre of
    another and opposite tilts cancel. All other steps process a margin of repeats around the drawing, so they
    treat an edge like any other place.

    Args:
        backend: the network.
        picture: the drawing.
        tile: directions in which the drawing repeats.
        mask: mask of the object (h, w), of any size; or the source `OUTLINE` or `MODEL`, as in
            `preparation.prepare`. None uses the drawing's opacity if it shows the object, otherwise the area
            that the lines of the repeated drawing enclose, or the whole drawing if many lines are open.
        hints: hints in pixels of the drawing, or None.
        longest: longer side of the map in pixels; None keeps the drawing's size.
        upsample: replaces the network's own upsampler.

    Raises:
        InputError: if the drawing has no lines, or the network sees no object.
    """
    shape = fitted(picture.shape, longest)
    worked = fitted_within(shape, MOST_TILED)
    if isinstance(mask, str) and mask == READER:
        raise InputError(
            "the reader cannot find the mask of a repeating drawing; use a file, outline or model."
        )
    room = (round(_BESIDE * max(worked)),) * 2
    page = picture.resized(worked, partial(resize_tile, tile=tile))
    ink, found, alpha = _read(page, mask, tile, room)
    around = wrapped(ink, tile, room)
    origin = (around.shape[0] - ink.shape[0]) // 2, (around.shape[1] - ink.shape[1]) // 2
    shown = windows(ink, tile, backend.size)
    frame = _frame_of(around, shown[0])
    scale = np.float32(worked[1] / picture.shape[1])
    own_hints = None if hints is None else Hints(hints.points * scale, hints.normals)
    predicted, confidence = predict_windows(backend, shown, frame, tile, worked, origin, own_hints)
    own = _part(frame, origin, worked)
    corner = -origin[0], -origin[1]
    prepared = Prepared(
        shape=(around.shape[0], around.shape[1]),
        ink=around,
        mask=None if found is None else wrapped(found, tile, room),
        alpha=alpha,
        frame=frame,
        model_input=render_model_input(around, frame, backend.line_widths),
        hints=None,
        map_hints=None if own_hints is None else repeated(own_hints, tile, worked, corner, around.shape),
        line_widths=backend.line_widths,
    )
    level = _levelled(predicted, predicted[own], tile)
    preds = finish(prepared, level, confidence, upsample or backend.upsample)
    inner = partial(middle, tile=tile, beside=room)
    whole = replace(
        preds,
        extended=inner(preds.extended),
        mask=inner(preds.mask),
        alpha=inner(preds.alpha),
        seen=preds.seen[own],
        confidence=None if preds.confidence is None else inner(preds.confidence),
        tile=tile,
    )
    if hints is not None and own_hints is not None:
        off = hints_off(hints.points, own_hints.points, whole.mask)
        whole = replace(whole, findings=whole.findings + off)
    return whole if worked == shape else _enlarged(whole, shape, tile)


def give_forms(preds: NormalMap, picture: Picture, form: Form) -> NormalMap:
    """Return a repeating map with a form applied to each area that lines enclose, such as each brick.

    Args:
        preds: map from `predict_tile`.
        picture: the drawing.
        form: form of each area.
    """
    shape, tile = preds.mask.shape, preds.tile
    assert tile is not None
    worked = fitted_within(shape, MOST_TILED)
    room = (round(_BESIDE * max(worked)),) * 2
    ink, _, _ = _read(picture.resized(worked, partial(resize_tile, tile=tile)), None, tile, room)
    small = preds if worked == shape else _enlarged(preds, worked, tile)
    # A whole repeat on each side, so that each area is complete somewhere.
    normals, lines, mask = (wrapped(each, tile, worked) for each in (small.extended, ink, small.mask))
    free = (lines <= INKED).astype(np.uint8)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=4)
    top, left = (side if there else 0 for side, there in zip(worked, repeats(tile), strict=True))
    formed = 0
    for number in range(1, count):
        x, y, width, height = stats[number, :4]
        complete = x > 0 and y > 0 and x + width < lines.shape[1] and y + height < lines.shape[0]
        shown = x < left + worked[1] and x + width > left and y < top + worked[0] and y + height > top
        if complete and shown:
            box = slice(y - 1, y + height + 1), slice(x - 1, x + width + 1)
            area = (labels[box] == number).astype(np.float32)
            normals[box] = give_form(normals[box], mask[box], area, form)
            formed += 1
    if not formed:
        none = Finding("note", words="its lines enclose no area, so none got a form")
        return replace(preds, findings=(*preds.findings, none))
    small = replace(small, extended=middle(normals, tile, worked))
    larger = small if worked == shape else _enlarged(small, shape, tile)
    return replace(preds, extended=larger.extended)


def _read(
    page: Picture, mask: MaskOrSource, tile: Tile, room: tuple[int, int]
) -> tuple[Floats, BoolMask | None, Floats | None]:
    """Return the lines (H, W) and the object (H, W) of a repeating drawing, and its opacity with repeats.

    The object is None for the model's own segmentation, and the opacity unless it shows the object.
    """
    alpha = None if page.alpha is None else wrapped(page.alpha, tile, room)
    beside = Picture(wrapped(page.colour, tile, room), alpha)
    cleaned = clean(beside, read(beside), repeats=True)
    ink = middle(cleaned.ink, tile, room)
    if isinstance(mask, np.ndarray):
        return ink, np.asarray(resize(mask.astype(np.float32), ink.shape) > 0.5), None
    if mask is None and cleaned.silhouette is not None:
        return ink, middle(cleaned.silhouette, tile, room), alpha
    return ink, None if mask == MODEL else _outlined(ink, tile), None


def _frame_of(around: Floats, window: Window) -> Frame:
    """Return a frame around a whole picture (H, W) at the scale of a window."""
    pixel = round(window.frame.side) / window.frame.size
    size = ceil(max(around.shape) / pixel)
    side = size * pixel
    return Frame(around.shape, (around.shape[1] - side) / 2, (around.shape[0] - side) / 2, side, size)


def _outlined(ink: Floats, tile: Tile) -> BoolMask:
    """Return the area that the lines (H, W) of a repeating drawing enclose; all of it if many are open."""
    half = ink.shape[0] // 2, ink.shape[1] // 2
    repeated = wrapped(ink, tile, half)
    enclosed = decide(repeated, None).mask
    if repeated[enclosed].sum() < _CLOSED * repeated.sum():
        return np.ones(ink.shape, np.bool_)
    mask = middle(enclosed, tile, half)
    # Gaps between enclosed areas, such as joints between stones, are part of the surface too.
    return np.ones(ink.shape, np.bool_) if mask.mean() > _ALL else mask


def _part(frame: Frame, origin: tuple[int, int], shape: tuple[int, int]) -> tuple[slice, slice]:
    """Return the rows and columns of a frame that the drawing (H, W) itself occupies."""
    pixel = round(frame.side) / frame.size
    top, left = (round((o - round(f)) / pixel) for o, f in zip(origin, (frame.top, frame.left), strict=True))
    return np.s_[top : top + round(shape[0] / pixel), left : left + round(shape[1] / pixel)]


def _levelled(predicted: Floats, own: Floats, tile: Tile) -> Floats:
    """Return a prediction without its mean slope along the directions that repeat.

    A repeating surface cannot rise overall, because it would jump at each edge.

    Args:
        predicted: (S, S, 3), vectors whose length is the probability of an object.
        own: (h, w, 3), the part of the prediction that belongs to the drawing itself.
        tile: directions in which the drawing repeats.
    """
    sure = own[lengths(own) > _SURE]
    if not len(sure):
        return predicted
    down, across = repeats(tile)
    facing = np.maximum(sure[:, 2:], _STEEPEST * np.linalg.norm(sure, axis=1, keepdims=True))
    slope = (sure[:, :2] / facing).mean(0) * np.array([across, down], np.float32)
    length = lengths(predicted)[..., None]
    level = predicted.copy()
    level[..., :2] -= slope * np.maximum(predicted[..., 2:], _STEEPEST * length)
    return unit(level) * length


def _enlarged(preds: NormalMap, shape: tuple[int, int], tile: Tile) -> NormalMap:
    """Return a map resized to (H, W) so that it still repeats."""
    larger = partial(resize_tile, shape=shape, tile=tile)
    return replace(
        preds,
        extended=unit(larger(preds.extended), front=True),
        mask=larger(preds.mask.astype(np.float32)) > 0.5,
        alpha=np.clip(larger(preds.alpha), 0, 1),
        confidence=None if preds.confidence is None else larger(preds.confidence),
    )
