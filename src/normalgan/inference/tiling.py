"""Tiling: a seamless map of a seamless drawing."""

from dataclasses import replace
from functools import partial
from math import ceil

import numpy as np

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.ink import clean
from normalgan.inference.cleaning.reader import read
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
from normalgan.inference.vectors import lengths, unit

__all__ = ["MOST_TILED", "predict_tile"]

_BESIDE = 0.25
"""How much of its repeats is worked on around a drawing, as a share of its longer side."""
MOST_TILED = int(MOST_WORKED / (1 + 2 * _BESIDE))
"""Longest side in pixels at which a drawing is worked on that is repeated."""
_CLOSED = 0.8
"""Share of the ink that must enclose something for that to be the object."""
_ALL = 0.9
"""Share of a tile that lines enclose from which all of it is the object."""
_SURE = 0.5
"""Vectors that are longer belong to the object."""
_STEEPEST = 0.2
"""Least nz, of a unit vector, that a slope is taken from."""


def predict_tile(
    backend: Backend,
    picture: Picture,
    tile: Tile,
    mask: MaskOrSource = None,
    hints: Hints | None = None,
    longest: int | None = None,
    upsample: Upsampler | None = None,
) -> NormalMap:
    """Predict the normal map of a drawing that repeats; the map repeats in the same directions.

    The network treats its input as a single round object. So it sees the repeated drawing in
    overlapping windows, weighted towards their centres. An edge of one window is in the centre
    of another, and opposite tilts cancel. All other steps see enough of the repeats around the drawing to
    treat an edge like any other place.

    Args:
        backend: the network.
        picture: the drawing.
        tile: the directions in which it repeats.
        mask: (h, w), the object, of any size; `OUTLINE` or `MODEL`, as `preparation.prepare` has them; None
            takes the drawing's opacity if that shows the object, else the area that the repeated drawing's
            lines enclose; if they leave much open, the whole drawing.
        hints: in pixels of the drawing.
        longest: longer side of the map in pixels; None keeps the drawing's own size.
        upsample: replaces the network's own step to the drawing's size.

    Raises:
        InputError: if there is no line in it, or the network sees no object.
    """
    shape = fitted(picture.shape, longest)
    worked = fitted_within(shape, MOST_TILED)
    if isinstance(mask, str) and mask == READER:
        raise InputError("a tile takes no mask from the reader; use a file, outline or model for its mask.")
    page = picture.resized(worked, partial(resize_tile, tile=tile))
    room = (round(_BESIDE * max(worked)),) * 2
    opacity = None if page.alpha is None else wrapped(page.alpha, tile, room)
    beside = Picture(wrapped(page.colour, tile, room), opacity)
    cleaned = clean(beside, read(beside), repeats=True)
    ink = middle(cleaned.ink, tile, room)
    silhouette = cleaned.silhouette if mask is None else None
    found = _object(mask, ink, tile) if silhouette is None else middle(silhouette, tile, room)
    shown = windows(ink, tile, backend.size)
    around = wrapped(ink, tile, room)
    origin = (around.shape[0] - ink.shape[0]) // 2, (around.shape[1] - ink.shape[1]) // 2
    frame = _frame_of(around, shown[0])
    given = hints
    if hints is not None:
        hints = Hints(hints.points * np.float32(worked[1] / picture.shape[1]), hints.normals)
    predicted, confidence = predict_windows(backend, shown, frame, tile, worked, origin, hints)
    own = _part(frame, origin, worked)
    predicted = _levelled(predicted, predicted[own], tile)
    before = -origin[0], -origin[1]
    prepared = Prepared(
        shape=(around.shape[0], around.shape[1]),
        ink=around,
        mask=None if found is None else wrapped(found, tile, room),
        alpha=None if silhouette is None else opacity,
        frame=frame,
        seen=render_model_input(around, frame, backend.line_widths),
        hints=None,
        pins=None if hints is None else repeated(hints, tile, worked, before, around.shape),
        line_widths=backend.line_widths,
    )
    preds = finish(prepared, predicted, confidence, upsample or backend.upsample)
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
    if given is not None and hints is not None:
        off = hints_off(given.points, hints.points, whole.mask)
        whole = replace(whole, findings=whole.findings + off)
    return whole if worked == shape else _enlarged(whole, shape, tile)


def _object(mask: MaskOrSource, ink: Floats, tile: Tile) -> BoolMask | None:
    """Return the object of a drawing (H, W) whose opacity does not tell; None leaves it to the model."""
    if isinstance(mask, np.ndarray):
        return np.asarray(resize(mask.astype(np.float32), ink.shape) > 0.5)
    return None if mask == MODEL else _outlined(ink, tile)


def _frame_of(around: Floats, window: Window) -> Frame:
    """Return the frame of a whole picture (H, W) at the scale of a window."""
    pixel = round(window.frame.side) / window.frame.size
    size = ceil(max(around.shape) / pixel)
    side = size * pixel
    return Frame(around.shape, (around.shape[1] - side) / 2, (around.shape[0] - side) / 2, side, size)


def _outlined(ink: Floats, tile: Tile) -> BoolMask:
    """Return the area that the lines (H, W) of a repeated drawing enclose, or all of it if many are open."""
    half = ink.shape[0] // 2, ink.shape[1] // 2
    repeated = wrapped(ink, tile, half)
    enclosed = decide(repeated, None).mask
    if repeated[enclosed].sum() < _CLOSED * repeated.sum():
        return np.ones(ink.shape, np.bool_)
    mask = middle(enclosed, tile, half)
    # Cracks between enclosed areas are not air: stones lie on the ground of a texture.
    return np.ones(ink.shape, np.bool_) if mask.mean() > _ALL else mask


def _part(frame: Frame, origin: tuple[int, int], shape: tuple[int, int]) -> tuple[slice, slice]:
    """Return where in a frame the drawing (H, W) itself is."""
    pixel = round(frame.side) / frame.size
    top, left = (round((o - round(f)) / pixel) for o, f in zip(origin, (frame.top, frame.left), strict=True))
    return np.s_[top : top + round(shape[0] / pixel), left : left + round(shape[1] / pixel)]


def _levelled(predicted: Floats, own: Floats, tile: Tile) -> Floats:
    """Remove a prediction's mean slope along the directions that repeat.

    A repeated surface cannot rise overall, because it would jump at each edge.

    Args:
        predicted: (S, S, 3), vectors whose length is the probability of an object.
        own: (h, w, 3), for the drawing itself.
        tile: the directions in which it repeats.
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
    """Return a map resized to (H, W) pixels that still repeats."""
    larger = partial(resize_tile, shape=shape, tile=tile)
    return replace(
        preds,
        extended=unit(larger(preds.extended), front=True),
        mask=larger(preds.mask.astype(np.float32)) > 0.5,
        alpha=np.clip(larger(preds.alpha), 0, 1),
        confidence=None if preds.confidence is None else larger(preds.confidence),
    )
