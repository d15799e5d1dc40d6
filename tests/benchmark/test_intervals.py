"""Intervals, against those of scipy: of means, of differences, over meshes and seeds."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import bootstrap, ttest_rel

from normalgan.benchmark.intervals import difference_interval, draws_of, mesh_interval, total_interval


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


def seeded(by_seed: list[list[float]]) -> list[dict[str, Any]]:
    """Return runs of the seeds 0, 1, …, each with an error by mesh."""
    return [{**a_run(values), "seed": seed} for seed, values in enumerate(by_seed)]


def test_with_equal_seeds_the_total_interval_is_students_over_the_meshes() -> None:
    found = total_interval(seeded([ONE, ONE, ONE]), seeded([OTHER, OTHER, OTHER]), "15", "angular_mean")
    assert found is not None
    wanted = ttest_rel(ONE, OTHER).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((wanted.low, wanted.high))


def test_with_equal_meshes_the_total_interval_is_students_over_the_seeds() -> None:
    ours, theirs = [16.0, 16.4, 17.1], [17.0, 17.1, 17.9]
    found = total_interval(
        seeded([4 * [v] for v in ours]), seeded([4 * [v] for v in theirs]), "15", "angular_mean"
    )
    assert found is not None
    wanted = ttest_rel(ours, theirs).confidence_interval(0.95)
    assert tuple(found) == pytest.approx((np.mean(ours) - np.mean(theirs), wanted.low, wanted.high))


@pytest.mark.slow
def test_the_interval_of_both_covers_the_true_difference_as_often_as_it_says() -> None:
    rng, covered, meshes_alone = np.random.default_rng(3), 0, 0
    for _ in range(300):
        true = 17 + rng.normal(0, 1, 5) + rng.normal(0, 0.3, (3, 1))
        other = true + 0.5 + rng.normal(0, 0.3, 5) + rng.normal(0, 0.3, (3, 1)) + rng.normal(0, 0.05, (3, 5))
        both = seeded(other.tolist()), seeded(true.tolist())
        wide, narrow = (f(*both, "15", "angular_mean") for f in (total_interval, difference_interval))
        assert wide is not None
        assert narrow is not None
        covered += wide.low <= 0.5 <= wide.high
        meshes_alone += narrow.low <= 0.5 <= narrow.high
    assert covered / 300 > 0.92
    assert meshes_alone / 300 < 0.8  # why the page quotes the other one


def test_the_interval_of_both_pairs_seeds_and_needs_two() -> None:
    ours, theirs = seeded([ONE, OTHER, ONE]), seeded([OTHER, ONE])
    found = total_interval(ours, theirs, "15", "angular_mean")
    assert found is not None
    assert found.value == pytest.approx(0)  # of seeds 0 and 1; seed 2 has no partner
    assert total_interval(ours[::-1], theirs, "15", "angular_mean") == found
    assert total_interval(ours, theirs[:1], "15", "angular_mean") is None
    assert total_interval([a_run(ONE)], [a_run(ONE)], "15", "angular_mean") is None  # no seeds
    assert tuple(total_interval(ours, ours, "15", "angular_mean") or ()) == (0, 0, 0)


def test_a_difference_may_be_of_other_hints() -> None:
    runs = seeded([ONE, OTHER])
    for run in runs:
        run["meshes"]["0"] = a_run([v + 2 for v in ONE])["meshes"]["15"]
    found = total_interval(runs, runs, "15", "angular_mean", "0")
    assert found is not None
    assert found.value == pytest.approx((np.mean(OTHER) - np.mean(ONE)) / 2 - 2)
