"""What the network sees of a part of a drawing."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.inference.composites.layer_context import context_of, surest, ways_to_see
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
    seen_alone, found = ways_to_see(back, context)
    assert seen_alone is back
    assert found.model_input is context.model_input
    assert found.mask is back.mask
    scale = context.frame.size / context.frame.side

    def ink(x: int, y: int) -> float:
        column, row = round((x - context.frame.left) * scale), round((y - context.frame.top) * scale)
        return float(context.model_input[row - 1 : row + 2, column - 1 : column + 2].max())

    assert ink(50, 100) > 0.5  # of the back
    assert ink(150, 100) > 0.5  # of the front
    assert ink(190, 100) < 0.1  # the back's, behind the front
    hidden = context_of([front, back])
    assert np.abs(hidden.model_input - context.model_input).max() > 0.5


def test_where_the_network_tells_the_object_a_part_is_seen_alone() -> None:
    back, front = part(120, 70), part(200, 50)
    context = context_of([back, front])
    alone = replace(back, mask=None)
    assert ways_to_see(alone, context) == [alone]
    assert ways_to_see(back, None) == [back]


@pytest.mark.parametrize("sure", [True, False], ids=["alone", "among"])
def test_a_part_is_seen_as_the_network_is_surer_of_it(sure: bool) -> None:
    back, front = part(120, 70), part(200, 50)
    alone, among = ways_to_see(back, context_of([back, front]))
    assert back.mask is not None
    paper = 1 - back.mask.astype(np.float32)

    def infer(way: Prepared) -> tuple[Floats, Floats]:
        confidence = np.full(way.model_input.shape, 9 if (way is alone) == sure else 3, np.float32)
        # What it thinks of the paper does not count.
        confidence[way.frame.shrink(paper) == 1] = 0 if way is alone else 100
        return np.full((*way.model_input.shape, 3), confidence.max(), np.float32), confidence

    chosen, normals, _ = surest([alone, among], infer)
    assert chosen is (alone if sure else among)
    assert normals.max() == (9 if sure else 100)


def test_a_network_that_does_not_say_how_sure_it_is_sees_a_part_alone() -> None:
    back, front = part(120, 70), part(200, 50)
    ways = ways_to_see(back, context_of([back, front]))
    assert surest(ways, lambda way: (np.zeros((*way.model_input.shape, 3), np.float32), None))[0] is back
