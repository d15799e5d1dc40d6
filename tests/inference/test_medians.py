"""Medians and other ranks, beside those of NumPy."""

import numpy as np
import pytest

from normalgan.inference.medians import median, ranked


@pytest.mark.parametrize("count", [1, 2, 3, 1000, 1001])
def test_the_median_is_that_of_numpy_to_the_bit(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count).astype(np.float32)
    assert median(values) == float(np.median(values))


@pytest.mark.parametrize("share", [0, 0.5, 0.95, 1])
def test_a_ranked_value_is_one_of_them_that_the_share_do_not_exceed(share: float) -> None:
    values = np.random.default_rng(1).normal(size=1000).astype(np.float32)
    assert ranked(values, share) == float(np.percentile(values, 100 * share, method="lower"))
