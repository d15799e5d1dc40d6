import numpy as np
import pytest

from normalgan.errors import InputError
from normalgan.inference.network.tile import Tile, check_tile, middle, repeats, resize_tile, wrapped
from normalgan.inference.reading.picture import resize


@pytest.mark.parametrize("tile", ["both", "x", "y"])
def test_where_the_edges_are_makes_no_difference_to_what_is_enlarged(tile: Tile) -> None:
    small = np.random.default_rng(0).random((40, 60, 3)).astype(np.float32)
    large = resize_tile(small, (80, 120), tile)
    assert np.abs(large - resize(small, (80, 120)))[8:-8, 8:-8].max() < 0.01
    for axis, there in enumerate(repeats(tile)):
        other = resize_tile(np.roll(small, 7, axis), (80, 120), tile)
        assert (np.abs(np.roll(large, 14, axis) - other).max() < 0.01) == there
        plain = resize(np.roll(small, 7, axis), (80, 120))
        assert np.abs(np.roll(resize(small, (80, 120)), 14, axis) - plain).max() > 0.1


def test_what_shrinks_is_averaged_and_needs_nothing_from_beyond_its_edges() -> None:
    small = np.random.default_rng(0).random((40, 60)).astype(np.float32)
    assert (resize_tile(small, (20, 30), "both") == resize(small, (20, 30))).all()


def test_the_middle_of_what_is_wrapped_is_the_picture() -> None:
    picture = np.random.default_rng(0).random((5, 7, 3))
    tile: Tile
    for tile in ("both", "x", "y"):
        assert (middle(wrapped(picture, tile, (9, 2)), tile, (9, 2)) == picture).all()
    assert wrapped(picture, "y", (9, 2)).shape == (23, 7, 3)
    assert (wrapped(picture, "both", (9, 2))[9 + 5 + 1, 2 + 7] == picture[1, 0]).all()


def test_another_way_of_repeating_is_refused() -> None:
    with pytest.raises(InputError, match=r"tile is 'z'; a drawing is repeated along x, y or both\."):
        check_tile("z")
