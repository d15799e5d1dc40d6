"""The kit on what data and measures are made of: what it says of those that do otherwise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import torch
from torch import Tensor

from normalgan.animals import make_animals
from normalgan.batch import Batch
from normalgan.data.augmentation import BatchAugmentation
from normalgan.data.recipe import Loadable
from normalgan.data.sources import DataSource, Pairs, SplitSettings
from normalgan.metrics import MapMetric, angular_error
from normalgan.testing import ConformanceError, check
from pairs_on_disk import write_pairs


class Worst(MapMetric):
    """The largest error on the object."""

    unit = "°"
    worst: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.add_state("worst", torch.tensor(0.0), dist_reduce_fx="max")

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = torch.maximum(self.worst, (angular_error(preds, target) * mask).max())

    def compute(self) -> Tensor:
        """Return degrees."""
        return self.worst


class OfTheBatch(Worst):
    """Forgets all but the last batch."""

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = (angular_error(preds, target) * mask).max()


class EverywhereMeasured(Worst):
    """Looks off the object too."""

    def update(self, preds: Tensor, target: Tensor, mask: Tensor) -> None:
        """Count a batch."""
        self.worst = torch.maximum(self.worst, (preds - target).abs().max())


class Alone(Worst):
    """Does not say how processes join."""

    def __init__(self) -> None:
        super().__init__()
        self.add_state("worst", torch.tensor(0.0), dist_reduce_fx="sum")


@dataclass(frozen=True)
class Mirror(BatchAugmentation):
    """Mirrors every sample, or every other by its seed.

    Args:
        always: every one.
    """

    always: bool = True

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return a mirrored batch."""
        if not self.always and seed % 2:
            return batch
        turn = torch.tensor([-1.0, 1, 1], device=batch["normal"].device).view(1, 3, 1, 1)
        mirrored: Batch = {
            **batch,
            "sketch": batch["sketch"].flip(-1),
            "normal": batch["normal"].flip(-1) * turn,
            "mask": batch["mask"].flip(-1),
        }
        if "hints" in batch:
            hints = batch["hints"].flip(-1)
            mirrored["hints"] = torch.cat([hints[:, :3] * turn, hints[:, 3:]], dim=1)
        return mirrored


class LeavesVectors(Mirror):
    """Moves pixels alone."""

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return a batch whose pixels were moved."""
        return {**batch, **{k: v.flip(-1) for k, v in batch.items() if isinstance(v, Tensor)}}  # type: ignore[typeddict-item]


class LosesHints(Mirror):
    """Forgets the hints."""

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return less than it was given."""
        made = super().__call__(batch, seed)
        return {"sketch": made["sketch"], "normal": made["normal"], "mask": made["mask"]}


class ForgetsHints(Mirror):
    """Leaves hints where they were."""

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return a batch with hints of the one before."""
        made = super().__call__(batch, seed)
        return {**made, "hints": batch["hints"]} if "hints" in batch else made


class Unseeded(Mirror):
    """Draws from the global state."""

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return a batch that is mirrored or not."""
        return super().__call__(batch, seed) if float(torch.rand(())) < 0.5 else batch


@dataclass(frozen=True)
class Horses(DataSource):
    """Six generated horses."""

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        """Return them by split."""
        horses = {horse.name: horse for horse in make_animals(6, settings.data_seed, ["horse"])}
        return {part: [horses[name] for name in of] for part, of in settings.deal([*horses]).items()}


def test_what_does_its_part_passes(tmp_path: Path) -> None:
    check(Worst())
    check(Mirror())
    check(Mirror(always=False))
    check(Horses())
    check(Pairs(str(write_pairs(tmp_path, 6))))


@pytest.mark.parametrize(
    ("metric", "sentence"),
    [
        (OfTheBatch(), "once a picture without an object was counted too"),
        (EverywhereMeasured(), "after the prediction off the mask was changed"),
        (Alone(), "when two processes measured a part each"),
    ],
)
def test_metrics_that_do_otherwise(metric: MapMetric, sentence: str) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check(metric)


@pytest.mark.parametrize(
    ("augmentation", "sentence"),
    [
        (LosesHints(), "lost hints"),
        (LeavesVectors(), r"left \d+% of the normals along the outline pointing inward"),
        (ForgetsHints(), r"left hints [\d.]+° from the normals where they lie"),
        (Unseeded(), "otherwise under the same seed|drew from or seeded"),
    ],
)
def test_augmentations_that_do_otherwise(augmentation: BatchAugmentation, sentence: str) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check(augmentation)


@dataclass(frozen=True)
class Thing:
    """Something that loads."""

    name: str
    value: Any = None

    def fingerprint(self) -> str:
        """Return what it is."""
        return self.name

    def load(self) -> Any:
        """Return what it holds."""
        return self.value


@dataclass(frozen=True)
class Texts(DataSource):
    """Things that are no meshes.

    Args:
        count: how many.
        twice: all of one name.
    """

    count: int = 3
    twice: bool = False

    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        """Return them."""
        names = [f"t{0 if self.twice else i}" for i in range(self.count)]
        return {"train": [Thing(name, "text") for name in names]}


def test_sources_that_do_otherwise() -> None:
    with pytest.raises(ConformanceError, match="Texts has t0, which loads as str; load must return a Mesh"):
        check(Texts())
    with pytest.raises(ConformanceError, match="has two things named t0"):
        check(Texts(twice=True))
