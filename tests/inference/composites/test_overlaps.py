"""Overlaps: of sprites whose boxes overlap each keeps its own pixels."""

import numpy as np

from normalgan.decoding import Decoded
from normalgan.inference.composites.cells import Cell
from normalgan.inference.composites.overlaps import separate


def test_a_drawn_part_belongs_to_the_box_that_holds_most_of_it() -> None:
    pixels = np.zeros((40, 60, 4), np.uint8)
    pixels[4:36, 2:20] = 255  # of a
    pixels[4:12, 24:50] = 255  # of b, whose corner reaches into the box of a
    cells = [Cell("a", 0, 0, 30, 40), Cell("b", 18, 0, 36, 14), Cell("far", 58, 38, 2, 2)]
    found, warnings = separate(cells, Decoded(pixels, (40, 60)))
    assert not warnings
    assert found[2].own is None
    first, second = found[0].own, found[1].own
    assert first is not None
    assert second is not None
    assert not first[4:12, 24:30].any()
    assert first[4:36, 2:20].all()
    assert not second[4:12, 0:2].any()
    assert second[4:12, 6:32].all()


def test_sprites_that_show_the_same_are_named() -> None:
    pixels = np.zeros((40, 60, 4), np.uint8)
    pixels[4:36, 2:20] = 255
    cells = [Cell("whole", 0, 0, 60, 40), Cell("part", 0, 0, 30, 40)]
    found, warnings = separate(cells, Decoded(pixels, (40, 60)))
    assert warnings == ["'whole' and 'part' show the same part of the sheet; it is predicted as 'part'"]
    assert found[0].own is not None
    assert not found[0].own[4:36, 2:20].any()


def test_a_sprite_that_shows_a_detail_of_another_is_named() -> None:
    pixels = np.zeros((40, 60, 4), np.uint8)
    pixels[4:36, 2:30] = 255
    cells = [Cell("fox", 0, 0, 40, 40), Cell("eye", 10, 10, 8, 8)]
    found, warnings = separate(cells, Decoded(pixels, (40, 60)))
    assert warnings == ["'eye' and 'fox' show the same part of the sheet; it is predicted as 'fox'"]
    assert found[0].own is not None
    assert found[0].own.all()
