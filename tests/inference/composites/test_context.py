"""What the network sees of a part of a drawing."""

from dataclasses import replace

import cv2
import numpy as np

from normalgan.arrays import Floats
from normalgan.inference.composites.context import context_of, in_context
from normalgan.inference.preparation import Prepared, prepare
from normalgan.inference.reading.picture import Picture


def part(x: int, radius: int) -> Prepared:
    """A circle on white paper."""
    grey = np.full((200, 300), 255, np.uint8)
    cv2.circle(grey, (x, 100), radius, (0,), 3, cv2.LINE_AA)
    colour: Floats = np.dstack([grey] * 3).astype(np.float32) / np.float32(255)
    return prepare(Picture(colour, None), 256)


def test_a_part_hides_the_lines_behind_it_and_is_seen_with_the_others() -> None:
    back, front = part(120, 70), part(200, 50)
    context = context_of([back, front])
    found = in_context(back, context)
    assert found.seen is context.seen
    assert found.mask is back.mask
    scale = context.frame.size / context.frame.side

    def ink(x: int, y: int) -> float:
        column, row = round((x - context.frame.left) * scale), round((y - context.frame.top) * scale)
        return float(context.seen[row - 1 : row + 2, column - 1 : column + 2].max())

    assert ink(50, 100) > 0.5  # of the back
    assert ink(150, 100) > 0.5  # of the front
    assert ink(190, 100) < 0.1  # the back's, behind the front
    hidden = context_of([front, back])
    assert np.abs(hidden.seen - context.seen).max() > 0.5


def test_where_the_network_tells_the_object_a_part_is_seen_alone() -> None:
    back, front = part(120, 70), part(200, 50)
    context = context_of([back, front])
    for alone in (replace(back, mask=None), replace(back, closed=0.5)):
        assert in_context(alone, context) is alone
    held = replace(back, closed=0.5, held=True)
    assert in_context(held, context).seen is context.seen
