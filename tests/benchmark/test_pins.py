from itertools import pairwise

import pytest
import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.methods import Method
from normalgan.benchmark.pins import STRATEGIES, pin_curve, pin_one_by_one
from normalgan.hints import UniformHints
from spheres import batch


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_pins_come_one_by_one_and_the_curve_is_over_the_same_pixels(strategy: str) -> None:
    """Facing the viewer until there are three pins, then the truth."""
    given: Batch = {**batch(size=48), "name": ["a/0", "b/1"]}
    numbers: list[int] = []
    places: list[Tensor] = []

    def predict(one: Batch, hints: Tensor | None) -> Tensor:
        number = 0 if hints is None else int(hints[0, 3].sum())
        numbers.append(number)
        if hints is not None:
            places.append(hints[:, 3:])
            torch.testing.assert_close(hints[:, :3], one["normal"] * hints[:, 3:])
        facing = torch.zeros_like(one["normal"])
        facing[:, 2] = 1
        return one["normal"] if number >= 3 else facing

    sums = pin_one_by_one(Method(predict, UniformHints()), given, strategy, 4)  # type: ignore[arg-type]
    assert numbers == [0, 1, 2, 3, 4]
    assert all(((after - before) >= 0).all() for before, after in pairwise(places))
    assert sums[:, -1].tolist() == (given["mask"].sum((1, 2, 3)) - 4).tolist()
    curve = pin_curve([sums[:1], sums[1:]])
    assert curve[0] == curve[1] == curve[2] > 10
    assert curve[3] == curve[4] == pytest.approx(0, abs=0.05)
    if strategy == "worst":  # of what faces the viewer the outline is farthest off
        first = given["normal"][:, 2:][places[0] > 0]
        assert first.max() < 0.5
