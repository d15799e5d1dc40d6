"""Tests of medians: NumPy's own are the reference."""

import numpy as np
import pytest

from normalgan.painting.levels import median


@pytest.mark.parametrize("count", [1, 2, 3, 4, 101, 5000])
def test_medians_are_those_of_numpy_to_the_last_bit(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count).astype(np.float32)
    assert median(values) == float(np.median(values))
    assert median(values.round(1)) == float(np.median(values.round(1)))
