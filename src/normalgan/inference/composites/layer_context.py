"""Layer context: predict each part of a drawing alone or among the others, by its confidence."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.preparation import Prepared
from normalgan.inference.suggestion import uncertainty

Inferred = tuple[Floats, Floats | None]
"""The network's prediction (S, S, 3), and its confidence κ (S, S) or None."""


@dataclass(frozen=True, eq=False)
class Context:
    """The network's input for all parts of a drawing together.

    Args:
        frame: the square around all parts.
        model_input: (S, S), the lines of all parts.
    """

    frame: Frame
    model_input: Floats


def context_of(parts: Iterable[Prepared]) -> Context:
    """Return the context of a drawing's parts; the object of a part hides the lines behind it.

    Args:
        parts: one or more parts of the same size, back to front. Each is read once and not kept.
    """
    parts = iter(parts)
    first = next(parts)
    ink = first.ink
    for front in parts:
        behind = ink if front.mask is None else np.where(front.mask, np.float32(0), ink)
        ink = np.maximum(behind, front.ink)
    frame = Frame.around(ink, first.frame.size)
    return Context(frame, render_model_input(ink, frame, first.line_widths))


def ways_to_see(part: Prepared, context: Context | None) -> list[Prepared]:
    """Return a part prepared alone, and prepared among the other parts; add hints afterwards.

    If the network decides on the mask, the part is only shown alone, because all other parts would count as
    object too.

    Args:
        part: a prepared part, as returned by `prepare`.
        context: the context of all parts; None if there are no other parts.
    """
    if context is None or part.mask is None:
        return [part]
    without_hints = replace(part, hints=None, map_hints=None, drawing_hints=None)
    return [part, replace(without_hints, frame=context.frame, model_input=context.model_input)]


def surest(
    ways: Sequence[Prepared], infer: Callable[[Prepared], Inferred]
) -> tuple[Prepared, Floats, Floats | None]:
    """Return the view of a part with the lowest expected error, its prediction and its confidence.

    A head without its body looks like a wedge, so a body part is best shown among the others. A figure in
    front of scenery is complete by itself, and the lines around it mislead. The network's confidence decides.

    Args:
        ways: views of the part; the first is used if the network has no confidence.
        infer: runs the network.
    """
    inferred = [infer(each) for each in ways]
    errors = [_expected_error(way, confidence) for way, (_, confidence) in zip(ways, inferred, strict=True)]
    best = int(np.argmin(errors))
    return ways[best], *inferred[best]


def _expected_error(part: Prepared, confidence: Floats | None) -> float:
    """Return the mean expected error on the object as a fraction of a right angle; 0 if unknown."""
    if confidence is None or part.mask is None:
        return 0.0
    inside = part.frame.shrink(part.mask.astype(np.float32)) > 0.5
    return float(uncertainty(confidence)[inside].mean()) if inside.any() else 0.0
