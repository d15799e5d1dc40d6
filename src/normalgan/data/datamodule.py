"""MeshDataModule: from meshes (or the embedded animals) to batches, and from drawings to be predicted."""

import warnings
from functools import cached_property
from typing import Any

from torch import Tensor
from torch.utils.data import DataLoader

from normalgan.batch import Batch
from normalgan.data.dataset import SampleDataset
from normalgan.data.items import Item, decode
from normalgan.data.loaders import Loaders
from normalgan.data.manifest import views_by_split
from normalgan.data.mean import evenly, mean_of_maps
from normalgan.data.render import open_samples, render_samples
from normalgan.data.settings import DataSettings
from normalgan.data.sketches import SketchDataset, SketchSample, collate_sketches
from normalgan.data.stream import StreamDataset
from normalgan.data.training_data import changes, describe_training_data
from normalgan.data.usable import find_unusable, leave_out
from normalgan.errors import InputError
from normalgan.painting.jobs import find_files
from normalgan.seeds import derive_seed


class MeshDataModule(DataSettings):
    """Renders sketches, normal maps and masks of meshes, and serves them; serves drawings to predict.

    What it can be told is in `DataSettings`.
    """

    _drawings: SketchDataset | None = None
    _training_data: dict[str, Any] | None = None

    # --- from meshes to samples -----------------------------------------------------------------------

    def prepare_data(self) -> None:
        """Render what is to be kept and is not in the cache yet; go on where it was interrupted."""
        if self.trainer is None or not self.trainer.predicting:
            self.render(thorough=False)

    def render(self, cluster: str | None = None, thorough: bool = True) -> None:
        """Render as `prepare_data` does.

        Args:
            cluster: a Dask cluster to render on instead of this machine.
            thorough: whether to check every byte in a distant store too, and to try failed meshes once more.
        """
        views_by_split(self.views_per_mesh, self.sources)  # refuses now what training would stumble over
        if any(self.kept.values()):
            render_samples(
                *(self.cache, self.kept, self.views_per_mesh, self.recipe, self.render_workers),
                cluster=cluster,
                thorough=thorough,
            )
        if self.on_the_fly:
            reasons = find_unusable(self.cache, self.sources["train"], self.render_workers)
            for name, reason in reasons.items():
                warnings.warn(f"the mesh {name} is left out: {reason}", stacklevel=2)
            leave_out(self.sources["train"], reasons, "train")

    def setup(self, stage: str) -> None:
        """Read the drawings, or note what is trained on: splits are opened when first asked for.

        Raises:
            InputError: if there are no drawings to predict, or one cannot be used.
        """
        if stage == "fit":
            self._training_data = describe_training_data(self, self.trainer.world_size if self.trainer else 1)
        if stage == "predict":
            if self.sketches is None:
                raise InputError("predict needs drawings: --data.sketches names a folder, a glob or a list.")
            files = find_files(self.sketches, hints=self.hints, mask=self.mask)
            self._drawings = SketchDataset(files, self.recipe.size, self.map_size)

    def state_dict(self) -> dict[str, Any]:
        """Return for a checkpoint what the training samples depend on."""
        return {"training_data": self._training_data} if self._training_data else {}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Warn if a run that is resumed was trained with other samples, or in another order."""
        before = state_dict.get("training_data")
        if self._training_data and before and (told := changes(before, self._training_data)):
            warnings.warn(
                f"the checkpoint was trained with other data, and goes on with what is given now: {told}.",
                stacklevel=2,
            )

    @cached_property
    def train_dataset(self) -> SampleDataset | StreamDataset:
        """Samples of the training meshes; on the fly, those of the first epoch have a number."""
        if not self.on_the_fly:
            return self._open("train")
        sources = self.sources["train"]
        usable = leave_out(sources, find_unusable(self.cache, sources), "train")
        memory = self.memory // max(self.workers, 1)
        return StreamDataset(usable, self.views_per_mesh["train"], self.recipe, memory)

    @cached_property
    def val_dataset(self) -> SampleDataset:
        """Samples of the validation meshes."""
        return self._open("val")

    @cached_property
    def test_dataset(self) -> SampleDataset:
        """Samples of the test meshes."""
        return self._open("test")

    def _open(self, split: str) -> SampleDataset:
        stores = open_samples(self.cache, self.kept, self.views_per_mesh, self.recipe, self.nearby)
        return SampleDataset(stores[split], self.memory)

    # --- from samples to batches ----------------------------------------------------------------------

    def train_dataloader(self) -> DataLoader[Item]:
        """Return shuffled batches; the order depends on the seed and the epoch alone."""
        return self._loaders().shuffled(self.train_dataset, self.seed)

    def val_dataloader(self) -> DataLoader[Item]:
        """Return the validation samples in order."""
        return self._loaders().in_order(self.val_dataset)

    def test_dataloader(self) -> DataLoader[Item]:
        """Return the test samples in order."""
        return self._loaders().in_order(self.test_dataset)

    def predict_dataloader(self) -> DataLoader[SketchSample]:
        """Return the drawings in order."""
        dataset = self.drawings
        # By name: Lightning builds the loader anew from its arguments when predicting.
        return DataLoader(dataset, batch_size=self.batch_size, collate_fn=collate_sketches)

    def _loaders(self) -> Loaders:
        replicas, rank = (self.trainer.world_size, self.trainer.global_rank) if self.trainer else (1, 0)
        # A trainer has its batches decoded by `on_after_batch_transfer`; others are given tensors to use.
        as_stored = self.trainer is not None
        return Loaders(self.batch_size, self.workers, replicas, rank, as_stored)

    def on_after_batch_transfer(self, batch: Batch, dataloader_idx: int) -> Batch:
        """Decode batches on the device they are on, and augment those of training there.

        Drawings to predict are decoded already.
        """
        trainer = self.trainer
        if "normal" in batch:
            batch = decode(batch)
        if self.augmentation is None or trainer is None or not trainer.training:
            return batch
        step = trainer.fit_loop.total_batch_idx
        return self.augmentation(batch, derive_seed("augment", self.seed, step, trainer.global_rank))

    # --- what others ask ------------------------------------------------------------------------------

    def mean_normal_map(self) -> Tensor:
        """Return the mean of the training maps, (3, H, W) of unit length, 0 where no object ever is.

        On the fly it is taken over views of the first epoch: all of them, or 1024 spread evenly.
        """
        dataset = self.train_dataset
        count = len(dataset)
        indices = evenly(count) if self.on_the_fly else range(count)
        return mean_of_maps(self._loaders().chosen(dataset, indices), self.recipe.size)

    @property
    def drawings(self) -> SketchDataset:
        """The drawings to predict, once `setup` has read them."""
        if self._drawings is None:
            raise RuntimeError("the drawings are read in setup('predict').")
        return self._drawings
