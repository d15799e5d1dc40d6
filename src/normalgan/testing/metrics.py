"""Checks of a metric."""

import torch
from torch import Tensor

from normalgan.metrics import MapMetric
from normalgan.testing.conformance import Check, demand, device_list, untouched_check
from normalgan.testing.pictures import pictures


def metric_checks() -> list[Check[MapMetric]]:
    """Return the named checks of a metric, for ``pytest.mark.parametrize``."""
    return [
        Check("a unique name", _named, "figure must be a name without dots"),
        Check("one number", _scalar, "compute must return one finite number"),
        Check("an empty mask", _empty, "a picture without an object must not change the result"),
        Check("no pixels outside the mask", _masked, "only pixels where mask is 1 may count"),
        Check("batches of any size", _batches, "the result must not depend on the batches"),
        Check("several processes", _processes, "states must be added with a dist_reduce_fx"),
        Check("reset", _reset, "reset must clear all states"),
        untouched_check(_value, _samples),
        Check("all available devices", _devices, "states must be added by add_state"),
    ]


def _samples(count: int = 3) -> tuple[Tensor, Tensor, Tensor]:
    """Return slightly wrong predicted normals, the true normals, and masks."""
    target, mask = pictures(count)
    tilt = torch.tensor([0.3, -0.2, 0.1]).view(1, 3, 1, 1) * torch.arange(1, count + 1).view(-1, 1, 1, 1)
    return (target + tilt) * mask, target, mask


def _value(metric: MapMetric, *batches: tuple[Tensor, Tensor, Tensor]) -> Tensor:
    fresh = metric.clone()
    fresh.reset()
    for batch in batches:
        fresh.update(*batch)
    value: Tensor = fresh.compute()
    return value


def _same(metric: MapMetric, one: Tensor, other: Tensor, when: str) -> None:
    alike = torch.allclose(one.double(), other.double(), rtol=1e-4, atol=1e-5, equal_nan=True)
    demand(alike, metric, f"gave {float(other):.6g} and not {float(one):.6g} {when}", "both must be the same")


def _named(metric: MapMetric) -> None:
    name = metric.figure
    demand(
        name and name.replace("_", "").isalnum(),
        metric,
        f"has the figure {name!r}",
        "it names a column and a torch module, so it may have only letters, digits and _",
    )


def _scalar(metric: MapMetric) -> None:
    value = _value(metric, _samples())
    demand(
        value.numel() == 1 and bool(value.isfinite().all()),
        metric,
        f"computed {value.tolist()}",
        "it must return one finite number for pictures with objects",
    )


def _empty(metric: MapMetric) -> None:
    preds, target, mask = _samples(1)
    nothing = (preds * 0, target * 0, mask * 0)
    one, other = _value(metric, _samples()), _value(metric, _samples(), nothing)
    _same(metric, one, other, "after a picture without an object was added")
    demand(
        _value(metric, nothing).numel() == 1,
        metric,
        "did not return a number for an empty mask",
        "return nan",
    )


def _masked(metric: MapMetric) -> None:
    preds, target, mask = _samples()
    half = mask.clone()
    half[..., : mask.shape[-1] // 2] = 0
    other = preds + (1 - half) * 0.7
    one, two = _value(metric, (preds, target, half)), _value(metric, (other, target, half))
    _same(metric, one, two, "after the prediction outside the mask was changed")


def _batches(metric: MapMetric) -> None:
    whole = _samples(4)
    parts = [tuple(part[i : i + n] for part in whole) for i, n in ((0, 1), (1, 3))]
    _same(metric, _value(metric, whole), _value(metric, *parts), "for the same samples in other batches")  # type: ignore[arg-type]


def _processes(metric: MapMetric) -> None:
    whole = _samples(4)
    one, other = metric.clone(), metric.clone()
    one.reset()
    other.reset()
    one.update(*(part[:1] for part in whole))
    other.update(*(part[1:] for part in whole))
    one.merge_state(other)
    _same(metric, _value(metric, whole), one.compute(), "when two processes each measured a part")


def _reset(metric: MapMetric) -> None:
    fresh = metric.clone()
    fresh.update(*_samples(2))
    fresh.reset()
    fresh.update(*_samples())
    _same(metric, _value(metric, _samples()), fresh.compute(), "after reset")


def _devices(metric: MapMetric) -> None:
    here = _value(metric, _samples())
    for device in device_list():
        moved = metric.clone().to(device)
        moved.reset()
        moved.update(*(part.to(device) for part in _samples()))
        _same(metric, here, moved.compute().cpu(), f"on {device}")
