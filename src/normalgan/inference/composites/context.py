"""Context: predicts each part of a drawing alone or among the others, by the network's confidence."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.preparation import Prepared
from normalgan.inference.suggestion import uncertainty

__all__ = ["Context", "Inferred", "context_of", "expected_error", "surest", "ways_to_see"]

Inferred = tuple[Floats, Floats | None]
"""What the network predicts, (S, S, 3), and its confidence κ, (S, S), if it has one."""


@dataclass(frozen=True, eq=False)
class Context:
    """The network's view of all parts of a drawing.

    Args:
        frame: the square around all of them.
        seen: (S, S), their lines.
    """

    frame: Frame
    seen: Floats


def context_of(parts: Iterable[Prepared]) -> Context:
    """Return the lines of all parts of a drawing; the object of a part hides the lines behind it.

    Args:
        parts: parts of the same size, back to front; at least one. Each is read once and not kept.
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
    """Return a part's map when shown alone, and when shown among the others; add hints afterwards.

    If the network decides on the object, the part is shown alone; otherwise all other parts would count as
    object.

    Args:
        part: as `prepare` gives it.
        context: the drawing that it is a part of; None if there are no other parts.
    """
    if context is None or part.mask is None:
        return [part]
    return [part, replace(part, frame=context.frame, seen=context.seen, hints=None, pins=None, given=None)]


def surest(
    ways: Sequence[Prepared], infer: Callable[[Prepared], Inferred]
) -> tuple[Prepared, Floats, Floats | None]:
    """Return the view of a part for which the network expects the least error, and its prediction.

    A head without its body looks like a wedge, so a body part is best shown among the others. A figure in
    front of scenery is complete, and the lines around it mislead. The network's confidence decides.

    Args:
        ways: the part as the network can be shown it; of a network without confidence, the first is used.
        infer: asks the network.
    """
    inferred = [infer(each) for each in ways]
    errors = [expected_error(way, confidence) for way, (_, confidence) in zip(ways, inferred, strict=True)]
    best = int(np.argmin(errors))
    return ways[best], *inferred[best]


def expected_error(part: Prepared, confidence: Floats | None) -> float:
    """Return the mean error that the network expects on the object, as a share of a right angle, or 0."""
    if confidence is None or part.mask is None:
        return 0.0
    inside = part.frame.shrink(part.mask.astype(np.float32)) > 0.5
    return float(uncertainty(confidence)[inside].mean()) if inside.any() else 0.0
