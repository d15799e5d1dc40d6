"""Tests what only this data source promises: whole stones, and a sketch that matches them."""

import numpy as np
import pytest
from normalgan_poisson import Pebbles

from normalgan.data.sources import Pair, SplitSettings
from normalgan.errors import InputError


def heap(seed: int = 0) -> Pair:
    return Pebbles(10, 96, 20.0).split(SplitSettings(data_seed=seed))["train"][0].load()


def test_stones_are_half_spheres_within_the_picture() -> None:
    pair = heap()
    assert not pair.mask[[0, -1]].any()
    assert not pair.mask[:, [0, -1]].any()
    assert pair.normal[pair.mask][:, 2].min() >= 0
    np.testing.assert_allclose(np.linalg.norm(pair.normal[pair.mask], axis=1), 1, atol=1e-6)
    assert pair.normal[..., 2].max() > 0.99


def test_the_outline_of_the_heap_is_drawn() -> None:
    pair = heap()
    ink = pair.sketch.colour[..., 0] < 0.5
    edge = pair.mask[:, 1:] != pair.mask[:, :-1]
    assert ink[:, :-1][edge].all()
    assert ink.mean() < 0.2


def test_the_seed_of_the_data_decides() -> None:
    assert np.array_equal(heap().normal, heap().normal)
    assert not np.array_equal(heap().normal, heap(1).normal)


@pytest.mark.parametrize(
    ("settings", "answer"),
    [
        ({"count": 0}, "count=0; use 1 heap or more"),
        ({"distance": 2.0}, "distance=2.0; use 4 pixels to a quarter of size=128"),
        ({"size": 64}, "distance=24.0; use 4 pixels to a quarter of size=64"),
    ],
)
def test_a_bad_setting_is_one_sentence(settings: dict[str, int], answer: str) -> None:
    with pytest.raises(InputError, match=answer):
        Pebbles(**settings)
