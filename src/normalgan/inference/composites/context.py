"""Context: the parts of a drawing as the network sees them among the others."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.mask.decision import CLOSED
from normalgan.inference.network.framing import Frame
from normalgan.inference.network.line_width import render_model_input
from normalgan.inference.preparation import Prepared

__all__ = ["Context", "context_of", "in_context"]


@dataclass(frozen=True, eq=False)
class Context:
    """What the network is shown of all parts of a drawing.

    Args:
        frame: the square around all of them.
        seen: (S, S), their lines.
    """

    frame: Frame
    seen: Floats


def context_of(parts: Sequence[Prepared]) -> Context:
    """Return the lines of all parts of a drawing; the object of a part hides the lines behind it.

    Args:
        parts: of one size, the hindmost first.
    """
    ink = parts[0].ink
    for front in parts[1:]:
        behind = ink if front.mask is None else np.where(front.mask, np.float32(0), ink)
        ink = np.maximum(behind, front.ink)
    frame = Frame.around(ink, parts[0].frame.size)
    return Context(frame, render_model_input(ink, frame, parts[0].line_widths))


def in_context(part: Prepared, context: Context) -> Prepared:
    """Return a part that is seen among the others; add hints afterwards.

    Where the network has a say in what is object, the part is seen alone, or all others were object too.

    Args:
        part: as `prepare` gives it.
        context: of the drawing that it is a part of.
    """
    if part.mask is None or (part.closed < CLOSED and not part.held):
        return part
    return replace(part, frame=context.frame, seen=context.seen, hints=None, pins=None, given=None)
