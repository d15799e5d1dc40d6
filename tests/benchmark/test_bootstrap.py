"""Intervals against scipy's bootstrap."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import bootstrap

from normalgan.benchmark.bootstrap import difference_interval, draws_of, mesh_interval


def a_run(values: list[float], pixels: list[int] | None = None) -> dict[str, Any]:
    counts = pixels or [100] * len(values)
    meshes = {
        f"m{i:02}": {"angular_mean": value, "pixels": count}
        for i, (value, count) in enumerate(zip(values, counts, strict=True))
    }
    return {"meshes": {"15": meshes}}


RNG = np.random.default_rng(5)
ONE = [float(v) for v in RNG.normal(17, 1.5, 20)]
OTHER = [v + float(d) for v, d in zip(ONE, RNG.normal(1, 0.3, 20), strict=True)]


def test_an_interval_is_that_of_scipy() -> None:
    found = mesh_interval([a_run(ONE)], "15", "angular_mean")
    assert found is not None
    wanted = bootstrap((ONE,), np.mean, method="percentile", n_resamples=20000, random_state=1)
    assert found.value == pytest.approx(np.mean(ONE))
    assert (found.low, found.high) == pytest.approx(tuple(wanted.confidence_interval), abs=0.03)


def test_a_difference_is_paired_as_scipys_is() -> None:
    found = difference_interval([a_run(ONE)], [a_run(OTHER)], "15", "angular_mean")
    assert found is not None
    wanted = bootstrap(
        (ONE, OTHER),
        lambda a, b, axis=-1: np.mean(a, axis) - np.mean(b, axis),
        paired=True,
        method="percentile",
        n_resamples=20000,
        random_state=1,
    )
    assert found.value == pytest.approx(np.mean(ONE) - np.mean(OTHER))
    assert (found.low, found.high) == pytest.approx(tuple(wanted.confidence_interval), abs=0.01)
    alone = mesh_interval([a_run(ONE)], "15", "angular_mean")
    assert alone is not None
    assert found.high - found.low < 0.5 * (alone.high - alone.low)  # the meshes' own hardness falls out


def test_few_meshes_are_drawn_in_every_way_and_weigh_by_their_pixels() -> None:
    assert len({tuple(draw) for draw in draws_of(5)}) == len(draws_of(5)) == 5**5
    found = mesh_interval([a_run([10, 20], [300, 100])], "15", "angular_mean")
    assert found is not None
    assert tuple(found) == pytest.approx((12.5, 10.1875, 19.4375))  # of 10, 12.5, 12.5, 20


def test_seeds_are_averaged_and_results_without_meshes_have_no_interval() -> None:
    both = mesh_interval([a_run(ONE), a_run(OTHER)], "15", "angular_mean")
    assert both is not None
    assert both.value == pytest.approx((np.mean(ONE) + np.mean(OTHER)) / 2)
    assert mesh_interval([{"figures": {}}], "15", "angular_mean") is None
    assert mesh_interval([a_run(ONE)], "0", "angular_mean") is None
    assert mesh_interval([], "15", "angular_mean") is None
    assert mesh_interval([a_run(ONE[:1])], "15", "angular_mean") is None  # of one mesh nothing is known
    assert difference_interval([a_run(ONE)], [a_run(ONE[:3])], "15", "angular_mean") is None
    missing = a_run(ONE)
    missing["meshes"]["15"]["m03"]["angular_mean"] = None
    assert mesh_interval([missing], "15", "angular_mean") is None
