"""Preparation: clean a drawing, find its mask and frame it for the network."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.cleaning import Cleaned, clean, ink_of_strokes
from normalgan.inference.cleaning.silhouette import contour
from normalgan.inference.findings import Finding, LackingError
from normalgan.inference.mask.decision import Decision, decide
from normalgan.inference.mask.masks import MODEL, READER, MaskOrSource
from normalgan.inference.mask.reader import Reading, drop_ground, lines_of, read
from normalgan.inference.network.framing import Bounds, Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import MOST_WORKED, Picture, fitted, resize
from normalgan.line_widths import USUAL_WIDTHS, LineWidths

__all__ = ["Prepared", "hinted", "prepare", "reframed"]

_LEAST = 0.01
"""Share of a picture that an object takes at least, and its ground, if no line tells it."""


@dataclass(frozen=True)
class Prepared:
    """A drawing that is ready for the network.

    Args:
        shape: (H, W) of the map to be.
        ink: (h, w), the drawing's lines, at the size it is worked on.
        mask: (h, w), the object by its opacity, a mask or the outline; None leaves it to the model.
        alpha: the drawing's opacity (any H, W), if the mask comes from it.
        frame: the square the model is shown.
        seen: (S, S), what it is shown.
        hints: (4, S, S), or None.
        pins: the hints in pixels of the map, or None.
        painted: (h, w), 1 where the user has added to the object, -1 where they have cut, 0 elsewhere; or
            None.
        line_widths: of the lines that the model is shown as they were drawn.
        given: the hints in pixels of the drawing, to check that they lie on the object; or None.
        unsure: findings about the mask; places are in pixels of the drawing.
        decision: how the mask was found in the lines, if it was.
        reading: the reader's output, if it was asked.
        coverage: (h, w) in [0, 1], how much of each pixel the mask covers, if it comes from the outline.
    """

    shape: tuple[int, int]
    ink: Floats
    mask: BoolMask | None
    alpha: Floats | None
    frame: Frame
    seen: Floats
    hints: Floats | None
    pins: Hints | None = None
    painted: NDArray[np.int8] | None = None
    line_widths: LineWidths = USUAL_WIDTHS
    given: Hints | None = None
    unsure: tuple[Finding, ...] = ()
    decision: Decision | None = None
    reading: Reading | None = None
    coverage: Floats | None = None


def prepare(
    picture: Picture,
    size: int,
    mask: MaskOrSource = None,
    hints: Hints | None = None,
    longest: int | None = None,
    painted: NDArray[np.int8] | None = None,
    line_widths: LineWidths = USUAL_WIDTHS,
    flips: Sequence[tuple[float, float]] = (),
    drawn: bool = False,
    on_seen: Callable[["Prepared"], object] | None = None,
) -> Prepared:
    """Clean and frame a picture.

    Args:
        picture: the drawing.
        size: side of the model's pictures.
        mask: (h, w), the object, of any size; or where it comes from: `OUTLINE` fills what lines enclose,
            `MODEL` leaves it to the model, `READER` lets the reader vote on what lines enclose; None uses
            the drawing's opacity if it shows the object, else the reader.
        hints: in pixels of the drawing.
        longest: longer side of the map in pixels; None keeps the drawing's own size.
        painted: (H, W) of any size, 1 where the user has added to the object, -1 where they have cut, 0
            elsewhere.
            An addition closes the gaps that it covers in an outline.
        line_widths: of the lines that the model knows, in its pixels; they are shown as they were drawn.
        flips: x and y in pixels of the drawing; the region that lines enclose there becomes a hole, or object
            if it is a hole.
        drawn: whether the picture is nothing but dark strokes on white, which are the ink as they are.
        on_seen: called with the input of the model, without mask and hints, as soon as it is known, so that
            the model can run while the mask is found.

    Raises:
        LackingError: if there is no line in it.
        InputError: if there is no region at a point of ``flips``.
    """
    shape = picture.shape if longest is None else fitted(picture.shape, longest)
    worked = shape if max(shape) <= MOST_WORKED else fitted(shape, MOST_WORKED)
    source = mask if isinstance(mask, str) else None
    asked = mask is None or source == READER
    shown, reading = picture.resized(worked), None
    if drawn:
        cleaned = ink_of_strokes(shown)
    else:
        cleaned, reading = _clean_and_read(picture, shown, asked, source == READER)
    if painted is not None:
        by_hand = cv2.resize(painted, worked[::-1], interpolation=cv2.INTER_NEAREST)
        painted = np.asarray(by_hand, np.int8)
    walls = cleaned.ink if painted is None else np.maximum(cleaned.ink, (painted > 0).astype(np.float32))
    frame = Frame.around(walls, size)
    prepared = Prepared(
        shape=shape,
        ink=cleaned.ink,
        mask=None,
        alpha=None,
        frame=frame,
        seen=render_model_input(cleaned.ink, frame, line_widths),
        hints=None,
        painted=painted,
        line_widths=line_widths,
    )
    if on_seen is not None:
        on_seen(prepared)
    scale = worked[1] / picture.shape[1]
    if isinstance(mask, np.ndarray):
        prepared = replace(prepared, mask=resize(mask.astype(np.float32), worked) > 0.5)
    elif mask is None and cleaned.silhouette is not None:
        prepared = replace(prepared, mask=cleaned.silhouette, alpha=picture.alpha)
    elif source != MODEL:
        if drawn and asked:
            reading = read(picture)
        decision = decide(walls, reading, [(x * scale, y * scale) for x, y in flips])
        seen = bool(decision.mask.any()) or bool(flips)
        prepared = replace(
            prepared,
            mask=decision.mask if seen else None,
            unsure=_in_drawing(decision.unsure, scale) if seen else (Finding("guessed"),),
            decision=decision,
            reading=reading,
            coverage=decision.coverage if seen else None,
        )
    if flips and prepared.decision is None:
        raise InputError("a hole is cut in what lines enclose, but its mask does not come from its lines.")
    return prepared if hints is None else hinted(prepared, hints, picture.shape)


def _in_drawing(findings: Sequence[Finding], scale: float) -> tuple[Finding, ...]:
    """Return findings with their places in pixels of the drawing, which is worked on at a scale."""
    return tuple(
        replace(each, places=tuple((x / scale, y / scale) for x, y in each.places)) for each in findings
    )


def _clean_and_read(
    picture: Picture, shown: Picture, asked: bool, always: bool
) -> tuple[Cleaned, Reading | None]:
    """Return a picture's ink and, if the reader votes on its object, the reading.

    Where cleaning finds no line, as in a sprite on a flat ground, the rim of the reader's object is its line.

    Args:
        picture: the drawing.
        shown: the same at the size that it is worked on.
        asked: whether the reader is asked at all.
        always: whether it is asked even if the opacity shows the object.

    Raises:
        LackingError: if neither finds anything.
    """
    with ThreadPoolExecutor(1) as beside:
        # Without opacity it is asked in any case, whatever cleaning finds.
        ahead = beside.submit(read, picture) if asked and picture.alpha is None else None
        try:
            cleaned = clean(shown)
        except LackingError:
            if ahead is None:
                raise
            reading = ahead.result()
            silhouette = reading.presence_at(shown.size) > 0.5
            if not _LEAST <= silhouette.mean() <= 1 - _LEAST:
                raise
            lines = np.where(silhouette, lines_of(reading, shown.size), 0)
            return Cleaned(np.maximum(lines, contour(silhouette)).astype(np.float32), None), reading
        if not asked or (cleaned.silhouette is not None and not always):
            return cleaned, None
        reading = read(picture) if ahead is None else ahead.result()
    return replace(cleaned, ink=drop_ground(cleaned.ink, reading)), reading


def reframed(prepared: Prepared, bounds: Bounds) -> Prepared:
    """Return a prepared drawing with a frame around a box in pixels of its ``ink``; add hints afterwards."""
    frame = Frame.about(bounds, prepared.ink.shape, prepared.frame.size)
    seen = render_model_input(prepared.ink, frame, prepared.line_widths)
    return replace(prepared, frame=frame, seen=seen, hints=None, pins=None, given=None)


def hinted(prepared: Prepared, hints: Hints | None, shape: tuple[int, int]) -> Prepared:
    """Return a prepared drawing with other hints; everything else, which takes most of the time, is kept.

    Args:
        prepared: as `prepare` gives it.
        hints: in pixels of the drawing; None for none.
        shape: (H, W) of the drawing.
    """
    if hints is None:
        return replace(prepared, hints=None, pins=None, given=None)
    points = hints.points * (prepared.ink.shape[1] / shape[1])
    pins = Hints(hints.points * np.float32(prepared.shape[1] / shape[1]), hints.normals)
    seen = prepared.frame.cut_points(points, hints.normals)
    return replace(prepared, hints=seen, pins=pins, given=hints)
