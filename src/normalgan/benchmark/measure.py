"""Measuring a method: with growing numbers of the common hints, and with those of its own sampler."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import cast

import torch
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.methods import Method
from normalgan.benchmark.points import hint_points
from normalgan.hints import hints_at
from normalgan.hints.draw import draw_hints_by_name
from normalgan.metrics import normal_map_metrics, without_hints

Figures = dict[str, dict[str, float | None]]
"""Figures by what was given (``15`` hints, ``own``) and by their own name, such as ``angular_mean``; None if
nothing was measured, or a map was not finite."""

OWN = "own"
"""Stands for the hints of the method's own sampler."""


def measure(
    method: Method, batches: Iterable[Batch], counts: Sequence[int], seed: int, device: torch.device
) -> Figures:
    """Return the figures of a method on the samples.

    A hinted pixel counts for no method, even if it takes no hints, so that all are measured on the same
    pixels. With their own samplers' hints the pixels differ from method to method. ``own`` also has
    ``hints``, the mean number of hints of a sample.

    Args:
        method: what is measured.
        batches: the samples; each is taken once.
        counts: numbers of common hints.
        seed: of the hints.
        device: where to paint and measure.
    """
    with true_float32():
        return _measure(method, batches, counts, seed, device)


def _measure(
    method: Method, batches: Iterable[Batch], counts: Sequence[int], seed: int, device: torch.device
) -> Figures:
    metrics = {str(count): normal_map_metrics().to(device) for count in counts}
    own = normal_map_metrics().to(device)
    hints_given = samples = 0
    for batch in batches:
        here = moved(batch, device)
        target, mask, names = here["normal"], here["mask"], here["name"]
        bare = method.paint(here, None)
        for count in counts:
            where = hint_points(mask, names, seed, count)
            given = method.takes_hints and count > 0
            preds = method.paint(here, hints_at(target, where)) if given else bare
            metrics[str(count)].update(preds, target, without_hints(mask, where))
        # On the CPU: another device would draw others.
        hints = draw_hints_by_name(method.sampler, batch["normal"], batch["mask"], names, seed).to(device)
        preds = method.paint(here, hints) if method.takes_hints else bare
        own.update(preds, target, without_hints(mask, hints[:, 3:]))
        hints_given += int(hints[:, 3].sum())
        samples += len(names)
    figures = {given: _plain(collection.compute()) for given, collection in {**metrics, OWN: own}.items()}
    figures[OWN]["hints"] = hints_given / max(samples, 1)
    return figures


@contextmanager
def true_float32() -> Iterator[None]:
    """Keep a GPU from convolving in TF32, of 10 bits, as PyTorch lets it; as on the CPU then."""
    before = torch.backends.cudnn.allow_tf32
    torch.backends.cudnn.allow_tf32 = False
    try:
        yield
    finally:
        torch.backends.cudnn.allow_tf32 = before


def moved(batch: Batch, device: torch.device) -> Batch:
    """Return the batch on a device."""
    return cast(Batch, {k: v.to(device) if isinstance(v, Tensor) else v for k, v in batch.items()})


def _plain(figures: dict[str, Tensor]) -> dict[str, float | None]:
    return {name: float(v) if v.isfinite() else None for name, v in sorted(figures.items())}
