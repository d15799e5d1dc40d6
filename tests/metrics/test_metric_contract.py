"""What torchmetrics asks of every metric of its own, asked of ours, one by one and not as a collection."""

import copy
import pickle
from collections.abc import Callable
from functools import partial

import pytest
import torch
from metric_samples import Sample, by_numpy, random_batch
from torch import Tensor

from normalgan.metrics import (
    MeanAngularError,
    MeanAngularErrorPerImage,
    MeanL1,
    MeanL2,
    MedianAngularError,
    NormalMapMetric,
    RootMeanSquareAngularError,
    ShareBelow,
)

METRICS: dict[str, Callable[..., NormalMapMetric]] = {
    "angular_mean": MeanAngularError,
    "angular_median": MedianAngularError,
    "angular_rmse": RootMeanSquareAngularError,
    "angular_mean_per_image": MeanAngularErrorPerImage,
    "l1": MeanL1,
    "l2": MeanL2,
    "below_7_5": partial(ShareBelow, 7.5),
    "below_30": partial(ShareBelow, 30.0),
}
each_metric = pytest.mark.parametrize("name", METRICS)
BATCHES = [random_batch(seed) for seed in range(4)]


def agrees(name: str, value: Tensor, batches: list[Sample]) -> bool:
    """Whether a value is that of the definition; the median is known to half a bin."""
    exact = by_numpy(batches)[name]
    return value.item() == pytest.approx(exact, abs=0.0051 if name == "angular_median" else 0, rel=1e-5)


def filled(name: str, *batches: Sample) -> NormalMapMetric:
    metric = METRICS[name]()
    for batch in batches:
        metric.update(*batch)
    return metric


@each_metric
def test_a_call_tells_of_its_batch_and_counts_it(name: str) -> None:
    metric = METRICS[name]()
    for number, batch in enumerate(BATCHES, 1):
        value = metric(*batch)
        assert agrees(name, value, [batch])
        assert torch.equal(value, filled(name, batch).compute())
        assert torch.equal(metric.compute(), filled(name, *BATCHES[:number]).compute())
    assert agrees(name, metric.compute(), BATCHES)


@each_metric
def test_batches_may_be_of_any_size(name: str) -> None:
    joined = (torch.cat(parts) for parts in zip(*BATCHES, strict=True))
    assert torch.equal(filled(name, *BATCHES).compute(), filled(name, tuple(joined)).compute())  # type: ignore[arg-type]


@each_metric
@pytest.mark.parametrize("dtype", [torch.float16, torch.bfloat16])
def test_half_precision_loses_what_the_input_lost_and_no_more(name: str, dtype: torch.dtype) -> None:
    halves = [(preds.to(dtype), target.to(dtype), mask) for preds, target, mask in BATCHES]
    value = filled(name, *halves).compute()
    assert value.dtype == torch.float32
    assert agrees(name, value, [(preds.float(), target.float(), mask) for preds, target, mask in halves])


@each_metric
def test_no_gradient_comes_through(name: str) -> None:
    metric = METRICS[name]()
    preds, target, mask = BATCHES[0]
    value = metric(preds.clone().requires_grad_(), target, mask)
    assert metric.is_differentiable is False
    assert not value.requires_grad
    assert not metric.compute().requires_grad


@each_metric
def test_worse_maps_are_worse_in_the_direction_it_tells(name: str) -> None:
    rng = torch.Generator().manual_seed(9)
    worse = [(p + 0.8 * torch.randn(p.shape, generator=rng), t, m) for p, t, m in BATCHES]
    metric = METRICS[name]()
    better, after = filled(name, *BATCHES).compute(), filled(name, *worse).compute()
    assert (after < better) if metric.higher_is_better else (after > better)


@each_metric
def test_what_it_is_cannot_be_changed(name: str) -> None:
    metric = METRICS[name]()
    for constant in ("is_differentiable", "higher_is_better"):
        with pytest.raises(RuntimeError, match="Can't change const"):
            setattr(metric, constant, not getattr(metric, constant))


@each_metric
@pytest.mark.parametrize(
    "copied", [NormalMapMetric.clone, copy.deepcopy, lambda metric: pickle.loads(pickle.dumps(metric))]
)
def test_a_copy_counts_on_its_own(name: str, copied: Callable[[NormalMapMetric], NormalMapMetric]) -> None:
    metric = filled(name, BATCHES[0])
    other = copied(metric)
    assert type(other) is type(metric)
    assert other is not metric
    other.update(*BATCHES[1])
    assert torch.equal(other.compute(), filled(name, *BATCHES[:2]).compute())
    assert torch.equal(metric.compute(), filled(name, BATCHES[0]).compute())


@each_metric
def test_hash_is_its_own(name: str) -> None:
    first, second = filled(name, BATCHES[0]), filled(name, BATCHES[0])
    assert len({first, second, first}) == 2


@each_metric
def test_checkpoints_do_not_grow_but_may_hold_it(name: str) -> None:
    metric = filled(name, *BATCHES)
    assert metric.state_dict() == {}
    metric.persistent(True)
    other = METRICS[name]()
    other.persistent(True)
    other.load_state_dict(metric.state_dict())
    other.update(*BATCHES[0])  # and goes on from there
    assert torch.equal(other.compute(), filled(name, *BATCHES, BATCHES[0]).compute())


@each_metric
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # scripting asks for all attributes, also old ones
def test_a_module_that_holds_it_can_be_scripted(name: str) -> None:
    class Measured(torch.nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.metric = METRICS[name]()

        def forward(self, values: Tensor) -> Tensor:
            return 2 * values

    scripted = torch.jit.script(Measured())
    assert torch.equal(scripted(torch.ones(2)), torch.full((2,), 2.0))
