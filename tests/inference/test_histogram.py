"""Medians and percentiles, beside those of NumPy."""

import numpy as np
import pytest

from normalgan.inference.histogram import Histogram, median, ranked


@pytest.mark.parametrize("count", [1, 2, 3, 1000, 1001])
def test_the_median_is_that_of_numpy_to_the_bit(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count).astype(np.float32)
    assert median(values) == float(np.median(values))


@pytest.mark.parametrize("share", [0, 0.5, 0.95, 1])
def test_a_ranked_value_is_one_of_them_that_the_share_do_not_exceed(share: float) -> None:
    values = np.random.default_rng(1).normal(size=1000).astype(np.float32)
    assert ranked(values, share) == float(np.percentile(values, 100 * share, method="lower"))


@pytest.mark.parametrize(("above", "below"), [(-np.inf, np.inf), (0.4, np.inf), (-np.inf, 0.3), (0.2, 0.9)])
@pytest.mark.parametrize("share", [0.005, 0.5, 0.7, 0.995])
def test_a_quantile_is_that_of_the_values_between_its_bounds(
    share: float, above: float, below: float
) -> None:
    values = np.random.default_rng(2).random((40, 50)).astype(np.float32)
    counted = values[(values > above - 1 / 8192) & (values < below + 1 / 8192)]
    found = Histogram(values, 0, 1).quantile(share, above, below)
    assert found == pytest.approx(float(np.percentile(counted, 100 * share)), abs=0.005)


def test_between_bounds_that_hold_nothing_there_is_no_quantile() -> None:
    levels = Histogram(np.full((8, 8), 0.5, np.float32), 0, 1)
    assert np.isnan(levels.quantile(0.5, above=0.6))
    assert np.isnan(levels.quantile(0.5, below=0.4))
    assert levels.count(0.4) == 64
    assert levels.count(0.6) == 0
