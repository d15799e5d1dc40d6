"""What normalgan asks of every hint sampler."""

import pytest
from normalgan_poisson import PoissonHints

from normalgan.hints import HintSampler
from normalgan.testing import Check, hint_sampler_checks


@pytest.mark.parametrize("sampler", [PoissonHints(4), PoissonHints(2.5, keep=0.5), PoissonHints()], ids=str)
@pytest.mark.parametrize("check", hint_sampler_checks(), ids=str)
def test_conforms(check: Check[HintSampler], sampler: PoissonHints) -> None:
    check(sampler)
