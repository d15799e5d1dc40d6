"""Preparation: a drawing as far as it gets without the model: cleaned, framed, its mask found."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.cleaning import Cleaned, clean
from normalgan.inference.cleaning.silhouette import contour
from normalgan.inference.jobs.plan import MODEL, READER
from normalgan.inference.mask.outline_mask import fill_outline, snap_outline
from normalgan.inference.mask.reader import Reading, drop_ground, read, vote
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
        guessed: whether that closed a gap so wide that it may have been meant.
        pins: the hints in pixels of the map to be, or None.
        painted: (h, w), 1 where a hand has added to the object, -1 where it has cut, 0 elsewhere; or None.
        held: whether the outline is open and the mask is the one before it was.
        scenery: whether the mask comes from the outline, and what is behind the object is painted too.
        line_widths: of the lines that the model is shown as they were drawn.
        given: the hints in pixels of the drawing, if they are to be looked for on the object; or None.
        unsure: what is to be said of regions of which the reader is unsure.
        coverage: (h, w) in [0, 1], how much of each pixel the mask covers, if it comes from the outline.
    """

    shape: tuple[int, int]
    ink: Floats
    mask: BoolMask | None
    alpha: Floats | None
    frame: Frame
    seen: Floats
    hints: Floats | None
    closed: float
    guessed: bool
    pins: Hints | None = None
    painted: NDArray[np.int8] | None = None
    held: bool = False
    scenery: bool = False
    line_widths: LineWidths = USUAL_WIDTHS
    given: Hints | None = None
    unsure: str = ""
    coverage: Floats | None = None


def prepare(
    picture: Picture,
    size: int,
    mask: BoolMask | None = None,
    hints: Hints | None = None,
    longest: int | None = None,
    source: str | None = None,
    painted: NDArray[np.int8] | None = None,
    line_widths: LineWidths = USUAL_WIDTHS,
) -> Prepared:
    """Clean and frame a picture.

    Args:
        picture: the drawing.
        size: side of the model's pictures.
        mask: (h, w), the object, of any size; None takes the drawing's opacity or fills its outline.
        hints: in pixels of the drawing.
        longest: longer side of the map in pixels; None keeps the drawing's own size.
        source: where the mask comes from if it is not given: `OUTLINE`, `MODEL`, `READER`, or None for the
            drawing's opacity if that tells, else its outline.
        painted: (H, W) of any size, 1 where a hand has added to the object, -1 where it has cut, 0 elsewhere.
            What was added closes the gaps that it covers in an outline.
        line_widths: of the lines that the model knows, in its pixels; they are shown as they were drawn.

    Raises:
        InputError: if there is no line in it.
    """
    shape = picture.shape if longest is None else fitted(picture.shape, longest)
    worked = shape if max(shape) <= MOST_WORKED else fitted(shape, MOST_WORKED)
    shown_whole = picture.resized(worked)
    unknown = mask is None and source in {None, READER}
    cleaned, reading = _clean_and_read(shown_whole, unknown, votes=unknown and source == READER)
    alpha, closed, guessed, from_outline, unsure = None, 1.0, False, False, ""
    coverage: Floats | None = None
    if painted is not None:
        shown = cv2.resize(painted, worked[::-1], interpolation=cv2.INTER_NEAREST)
        painted = np.asarray(shown, np.int8)
    walls = cleaned.ink if painted is None else np.maximum(cleaned.ink, (painted > 0).astype(np.float32))
    frame = Frame.around(walls, size)
    if mask is not None:
        mask = resize(mask.astype(np.float32), worked) > 0.5
    elif source is None and cleaned.silhouette is not None:
        mask, alpha = cleaned.silhouette, picture.alpha
    elif source != MODEL:
        outline = fill_outline(walls)
        mask, coverage = outline.mask, outline.coverage
        closed, guessed = outline.closed, outline.guessed
        from_outline = True
        if reading is not None:
            voted = vote(walls, mask, reading.presence)
            if voted.mask.any():
                coverage = snap_outline(voted.mask, walls)
                mask, closed, guessed, unsure = coverage > 0.5, 1.0, False, voted.unsure
    prepared = Prepared(
        shape=shape,
        ink=cleaned.ink,
        mask=mask,
        alpha=alpha,
        frame=frame,
        seen=render_model_input(cleaned.ink, frame, line_widths),
        hints=None,
        closed=closed,
        guessed=guessed,
        painted=painted,
        scenery=from_outline and cleaned.scenery,
        line_widths=line_widths,
        unsure=unsure,
        coverage=coverage,
    )
    return prepared if hints is None else hinted(prepared, hints, picture.shape)


def _clean_and_read(picture: Picture, unknown: bool, votes: bool) -> tuple[Cleaned, Reading | None]:
    """Return a picture's ink and, if the reader votes on its object, what that sees in it.

    Where cleaning finds no line, as in a sprite on a flat ground, the rim of the reader's object is its line.

    Args:
        picture: of the drawing.
        unknown: whether nothing but the picture tells the object.
        votes: whether the reader is asked in any case.

    Raises:
        InputError: if neither finds anything.
    """
    try:
        cleaned = clean(picture)
    except InputError:
        if not unknown or picture.alpha is not None:
            raise
        reading = read(picture)
        silhouette = reading.presence > 0.5
        if not _LEAST <= silhouette.mean() <= 1 - _LEAST:
            raise
        lines = np.where(silhouette, reading.ink, 0)
        return Cleaned(np.maximum(lines, contour(silhouette)).astype(np.float32), None), reading
    if not votes:
        return cleaned, None
    reading = read(picture)
    return replace(cleaned, ink=drop_ground(cleaned.ink, reading)), reading


def reframed(prepared: Prepared, bounds: Bounds) -> Prepared:
    """Return a prepared drawing framed about a box in pixels of its ``ink``; give hints afterwards."""
    frame = Frame.about(bounds, prepared.ink.shape, prepared.frame.size)
    seen = render_model_input(prepared.ink, frame, prepared.line_widths)
    return replace(prepared, frame=frame, seen=seen, hints=None, pins=None, given=None)


def hinted(prepared: Prepared, hints: Hints | None, shape: tuple[int, int]) -> Prepared:
    """Return a prepared drawing with other hints: all else stays, which takes most of the time.

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
