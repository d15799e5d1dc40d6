"""Runs normalgan's checks for every hint sampler, data source and metric."""

import pytest
from normalgan_poisson import Pebbles, PoissonHints, WorstPicture

from normalgan.data.sources import DataSource
from normalgan.hints import HintSampler
from normalgan.metrics import MapMetric
from normalgan.testing import Check, checks


@pytest.mark.parametrize("sampler", [PoissonHints(4), PoissonHints(2.5, keep=0.5), PoissonHints()], ids=str)
@pytest.mark.parametrize("check", checks(HintSampler), ids=str)
def test_the_sampler_conforms(check: Check[HintSampler], sampler: PoissonHints) -> None:
    check(sampler)


@pytest.mark.parametrize("check", checks(DataSource), ids=str)
def test_the_data_source_conforms(check: Check[DataSource]) -> None:
    check(Pebbles(10, 64, 16.0))


@pytest.mark.parametrize("check", checks(MapMetric), ids=str)
def test_the_metric_conforms(check: Check[MapMetric]) -> None:
    check(WorstPicture())
