"""Preparation: clean a drawing, find its mask and frame it for the network."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.ink import clean
from normalgan.inference.cleaning.reader import Reading, read
from normalgan.inference.findings import Finding
from normalgan.inference.mask.decision import Decision, NoRegionError, decide
from normalgan.inference.mask.mask_files import MaskOrSource
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.reading.hint_files import Hints
from normalgan.inference.reading.picture import MOST_WORKED, Picture, fitted, resize
from normalgan.inference.regions import Bounds
from normalgan.line_widths import USUAL_WIDTHS, LineWidths


@dataclass(frozen=True)
class Prepared:
    """A drawing that is ready for the network.

    Args:
        shape: (H, W) of the map.
        ink: (h, w), lines of the drawing at the working size.
        mask: (h, w), the object; None uses the model's own segmentation.
        alpha: opacity of the drawing, of any size, if the mask comes from it; otherwise None.
        frame: the square of the drawing that is the model's input.
        model_input: (S, S), the model's input.
        hints: (4, S, S), hints as the model takes them, or None.
        map_hints: hints in pixels of the map, or None.
        painted: (h, w), the user's edits of the mask: 1 where they added to the object, -1 where they cut
            from it, 0 elsewhere; or None.
        line_widths: range of line widths, in pixels of the model, that are kept as drawn.
        drawing_hints: hints in pixels of the drawing, to check that they lie on the object; or None.
        unsure: findings about the mask; places are in pixels of the drawing.
        decision: how the mask was found from the lines, or None.
        reading: the reader's output if it voted on the mask, or None.
        coverage: (h, w) in [0, 1], coverage of each pixel by the mask if the mask comes from the outline, or
            None.
    """

    shape: tuple[int, int]
    ink: Floats
    mask: BoolMask | None
    alpha: Floats | None
    frame: Frame
    model_input: Floats
    hints: Floats | None
    map_hints: Hints | None = None
    painted: NDArray[np.int8] | None = None
    line_widths: LineWidths = USUAL_WIDTHS
    drawing_hints: Hints | None = None
    unsure: tuple[Finding, ...] = ()
    decision: Decision | None = None
    reading: Reading | None = None
    coverage: Floats | None = None


def prepare(
    picture: Picture,
    network_size: int,
    mask: MaskOrSource = None,
    hints: Hints | None = None,
    longest: int | None = None,
    painted: NDArray[np.int8] | None = None,
    line_widths: LineWidths = USUAL_WIDTHS,
    holes: Sequence[tuple[float, float]] = (),
    clean_strokes: bool = False,
    reading: Reading | None = None,
    on_model_input: Callable[["Prepared"], object] | None = None,
    reader: Callable[[Picture], Reading] = read,
) -> Prepared:
    """Clean a drawing, find its mask and frame it.

    Args:
        picture: the drawing.
        network_size: side of the model's input in pixels.
        mask: mask of the object (h, w), of any size; or a source: `OUTLINE` fills the areas that lines
            enclose, `READER` lets the reader decide on each of these areas, `MODEL` uses the model's own
            segmentation. None uses the drawing's opacity if it shows the object, otherwise the reader.
        hints: hints in pixels of the drawing, or None.
        longest: longer side of the map in pixels; None keeps the drawing's size.
        painted: the user's edits of the mask (H, W), of any size: 1 where they added to the object, -1 where
            they cut from it, 0 elsewhere. An addition also closes gaps in an outline.
        line_widths: range of line widths, in pixels of the model, that are kept as drawn.
        holes: x and y of points in pixels of the drawing; the enclosed region at each point changes from
            object to hole, or from hole to object.
        clean_strokes: whether the picture consists of dark strokes on white, which are used as ink unchanged.
        reading: the reader's output for the picture, if it is known; None reads the picture.
        on_model_input: called with the drawing, still without mask and hints, as soon as the model's input is
            known, so that the model can run while the mask is found.
        reader: reads the picture.

    Raises:
        LackingError: if the drawing has no lines.
        InputError: if a point of ``holes`` lies in no region.
    """
    shape = fitted(picture.shape, longest)
    # Lines of a tiny sprite are as wide as its details; enlarged, they can be told apart and thinned.
    worked = fitted(shape, min(max(network_size, *shape), MOST_WORKED))
    if reading is None and not clean_strokes:
        reading = reader(picture)
    cleaned = clean(picture.resized(worked), reading, drawn_pixel=worked[1] / picture.size[1])
    if painted is not None:
        by_hand = cv2.resize(painted, worked[::-1], interpolation=cv2.INTER_NEAREST)
        painted = np.asarray(by_hand, np.int8)
    walls = cleaned.ink if painted is None else np.maximum(cleaned.ink, (painted > 0).astype(np.float32))
    frame = Frame.around(walls, network_size)
    prepared = Prepared(
        shape=shape,
        ink=cleaned.ink,
        mask=None,
        alpha=None,
        frame=frame,
        model_input=render_model_input(cleaned.ink, frame, line_widths),
        hints=None,
        painted=painted,
        line_widths=line_widths,
    )
    if on_model_input is not None:
        on_model_input(prepared)
    scale = worked[1] / picture.shape[1]
    match mask:
        case np.ndarray():
            prepared = replace(prepared, mask=resize(mask.astype(np.float32), worked) > 0.5)
        case None if cleaned.silhouette is not None:
            prepared = replace(prepared, mask=cleaned.silhouette, alpha=picture.alpha)
        case "outline":
            prepared = _decided(prepared, walls, None, holes, scale)
        case "reader" | None:
            prepared = _decided(prepared, walls, reading or reader(picture), holes, scale)
    if holes and prepared.decision is None:
        raise InputError("a hole needs a region between lines, but the mask does not come from the lines.")
    return prepared if hints is None else hinted(prepared, hints, picture.shape)


def _decided(
    prepared: Prepared,
    walls: Floats,
    reading: Reading | None,
    holes: Sequence[tuple[float, float]],
    scale: float,
) -> Prepared:
    """Return a prepared drawing with the mask that its lines and the reader show, if they show an object.

    Args:
        prepared: the drawing without a mask.
        walls: (h, w), the lines, including the areas added by the user.
        reading: the reader's output; None decides by the lines alone.
        holes: as in `prepare`.
        scale: pixels of ``walls`` per pixel of the drawing.
    """
    try:
        decision = decide(walls, reading, [(x * scale, y * scale) for x, y in holes])
    except NoRegionError as error:
        raise NoRegionError.at(error.x / scale, error.y / scale) from None
    if not decision.mask.any() and not holes:
        return replace(prepared, unsure=(Finding("guessed"),), decision=decision, reading=reading)
    unsure = tuple(
        replace(each, places=tuple((x / scale, y / scale) for x, y in each.places))
        for each in decision.unsure
    )
    return replace(
        prepared,
        mask=decision.mask,
        unsure=unsure,
        decision=decision,
        reading=reading,
        coverage=decision.coverage,
    )


def reframed(prepared: Prepared, bounds: Bounds) -> Prepared:
    """Return a prepared drawing framed around a box in pixels of its ``ink``, without hints."""
    frame = Frame.about(bounds, prepared.ink.shape, prepared.frame.size)
    shown = render_model_input(prepared.ink, frame, prepared.line_widths)
    return replace(prepared, frame=frame, model_input=shown, hints=None, map_hints=None, drawing_hints=None)


def hinted(prepared: Prepared, hints: Hints | None, shape: tuple[int, int]) -> Prepared:
    """Return a prepared drawing with other hints; everything else is reused, which saves most of the time.

    Args:
        prepared: the prepared drawing, from `prepare`.
        hints: hints in pixels of the drawing; None removes them.
        shape: (H, W) of the drawing.
    """
    if hints is None:
        return replace(prepared, hints=None, map_hints=None, drawing_hints=None)
    ink_points = hints.points * (prepared.ink.shape[1] / shape[1])
    map_hints = Hints(hints.points * np.float32(prepared.shape[1] / shape[1]), hints.normals)
    model_hints = prepared.frame.cut_points(ink_points, hints.normals)
    return replace(prepared, hints=model_hints, map_hints=map_hints, drawing_hints=hints)
