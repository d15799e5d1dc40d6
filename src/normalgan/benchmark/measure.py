"""Measure a method with increasing numbers of common hints, and with its own sampler's hints."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Self

import torch
from lightning.fabric.utilities import move_data_to_device
from torch import Tensor

from normalgan.batch import Batch
from normalgan.benchmark.accumulator import Accumulator, Figure
from normalgan.benchmark.hints import hint_points, noisy_hints
from normalgan.benchmark.methods import Method
from normalgan.hints import HintSampler, hints_at
from normalgan.hints.draw import draw_hints_by_name
from normalgan.metrics import METRICS, MapMetric, angular_error
from normalgan.metrics.collection import check_names
from normalgan.weights.class_spec import ANY_NUMBER, ClassSpec

OWN = "own"
"""Name of the figures with the hints of the method's own sampler."""


@dataclass(frozen=True)
class Measured:
    """The figures of a method, by the hints that it was given, such as ``15`` or ``own``.

    Args:
        figures: figures over all samples, such as ``angular_mean``; a figure is None if it is undefined or a
            map was not finite.
        meshes: figures per mesh.
        distance: errors by distance from the contour; see `Accumulator.by_distance`.
        calibration: calibration curve of the confidence, or None.
    """

    figures: dict[str, Figure]
    meshes: dict[str, dict[str, Figure]]
    distance: dict[str, dict[str, list[Figure]]]
    calibration: dict[str, list[dict[str, float]] | None]

    @classmethod
    def of(cls, gathered: Mapping[str, Accumulator]) -> Self:
        """Return the figures of accumulated predictions."""
        return cls(
            figures={given: one.figures() for given, one in gathered.items()},
            meshes={given: one.by_mesh() for given, one in gathered.items()},
            distance={given: one.by_distance() for given, one in gathered.items()},
            calibration={given: one.calibration() for given, one in gathered.items()},
        )


@dataclass(frozen=True)
class HintTests:
    """The hints with which methods are tested, in addition to their own samplers' hints.

    Args:
        counts: numbers of common hints, uniform on the object.
        seed: seed of all hints.
        placements: samplers, by the name of their figures.
        noise: errors of hints in degrees and pixels, by the name of their figures.
        noisy: number of common hints in tests with noise.
        metrics: additional metrics, measured with all hints.
    """

    counts: Sequence[int]
    seed: int = 0
    placements: Mapping[str, HintSampler] = field(default_factory=dict)
    noise: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noisy: int = 15
    metrics: Sequence[MapMetric] = ()

    @property
    def names(self) -> list[str]:
        """The names of all figures."""
        return [*map(str, self.counts), *self.placements, *self.noise, OWN]


def more_metrics(named: Sequence[str | dict[str, Any]]) -> list[MapMetric]:
    """Return the metrics that a plan names.

    Args:
        named: names of registered classes, or mappings with ``class_path`` and ``init_args``.

    Raises:
        InputError: if a metric is unknown, its settings are invalid, or two metrics have the same name.
    """
    given = [{"class_path": each} if isinstance(each, str) else each for each in named]
    metrics = [ClassSpec.of(each, ANY_NUMBER).build(METRICS) for each in given]
    check_names(metrics)
    return metrics


def measure(method: Method, batches: Iterable[Batch], tests: HintTests, device: torch.device) -> Measured:
    """Return the figures of a method on the samples.

    Hinted pixels are not counted, even for methods without hints, so that all methods are measured on the
    same pixels. With the hints of their own samplers, the pixels differ between methods. ``own`` also has
    ``hints``, the mean number of hints per sample.
    """
    gathered = {given: Accumulator(device, tests.metrics) for given in tests.names}
    hints_given = 0
    with true_float32():
        for batch in batches:
            here: Batch = move_data_to_device(batch, device)
            target, mask, names = here["normal"], here["mask"], here["name"]
            bare = method.predict(here, None)
            error = angular_error(bare[:, :3], target).cpu()
            for given, drawn in _hints(method.sampler, batch, error, tests):
                hints, where = drawn.to(device), drawn[:, 3:].to(device)
                predicts = method.takes_hints and bool(where.any())
                predicted = method.predict(here, hints) if predicts else bare
                gathered[given].update(predicted, target, mask, where, names)
                if given == OWN:
                    hints_given += int(where.sum())
    measured = Measured.of(gathered)
    measured.figures[OWN]["hints"] = hints_given / max(gathered[OWN].samples, 1)
    return measured


def _hints(own: HintSampler, batch: Batch, error: Tensor, tests: HintTests) -> Iterator[tuple[str, Tensor]]:
    """Yield the hints (N, 4, H, W) by name, drawn on the CPU, because other devices draw other hints."""
    normal, mask, names, seed = batch["normal"], batch["mask"], batch["name"], tests.seed
    for count in tests.counts:
        yield str(count), hints_at(normal, hint_points(mask, names, seed, count))
    for name, sampler in {**tests.placements, OWN: own}.items():
        yield name, draw_hints_by_name(sampler, normal, mask, names, seed, error)
    where = hint_points(mask, names, seed, tests.noisy)
    for name, (degrees, pixels) in tests.noise.items():
        yield name, noisy_hints(normal, mask, where, names, seed, degrees, pixels)


@contextmanager
def true_float32() -> Iterator[None]:
    """Disable TF32, which has a 10-bit mantissa, so that a GPU gives the same figures as the CPU."""
    before = torch.backends.cudnn.allow_tf32
    torch.backends.cudnn.allow_tf32 = False
    try:
        yield
    finally:
        torch.backends.cudnn.allow_tf32 = before
