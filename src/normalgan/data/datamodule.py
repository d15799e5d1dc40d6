"""MeshDataModule: from meshes (or the embedded animals) to batches, and from drawings to be predicted."""

from functools import cached_property

import torch
from lightning.pytorch import LightningDataModule
from torch import Tensor
from torch.utils.data import DataLoader, Dataset
from torch.utils.data.distributed import DistributedSampler

from normalgan.batch import Batch
from normalgan.data.augmentation import Augmentation
from normalgan.data.dataset import Item, SampleDataset, collate
from normalgan.data.render import open_samples, render_samples
from normalgan.data.shares import EqualShare
from normalgan.data.sketches import SketchDataset, SketchSample, collate_sketches
from normalgan.data.sources import find_sources, split_sources
from normalgan.errors import InputError
from normalgan.framing import Frame
from normalgan.metrics import unit_vectors
from normalgan.rendering import EmbreeRenderer, MeshSource, Renderer, Views
from normalgan.rendering.lines import LineDrawing, SuggestiveContours
from normalgan.rendering.samples import Recipe
from normalgan.seeds import derive_seed


class MeshDataModule(LightningDataModule):
    """Renders sketches, normal maps and masks of meshes once, and serves them; serves drawings to predict.

    Args:
        meshes: a folder, a glob or a list of mesh files (.off .obj .ply .stl .glb .gltf); None takes the
            embedded procedural animals.
        animals: how many embedded animals there are, if no meshes are given.
        orientation: JSON file that says of each mesh how it is turned upright, and whether inside out.
        crease_angle: degrees from which an edge is sharp; None shades everything smooth.
        split_file: JSON file that lists the train, val and test meshes; None splits by fractions.
        fractions: shares of train, val and test meshes, if there is no split file.
        split_seed: which meshes go where, if there is no split file.
        views: where the objects are looked at from.
        renderer: what turns a mesh and a camera into maps.
        lines: the style of the sketches.
        size: side of the pictures in pixels.
        train_views: views of each training mesh.
        val_views: views of each validation mesh.
        test_views: views of each test mesh.
        cache: folder or URL where rendered samples are kept.
        render_workers: processes that render side by side; 0 renders in this one.
        batch_size: samples a batch.
        workers: processes that load samples; 0 loads in this one, enough where they fit in memory.
        memory: bytes that a split may take in memory; larger ones are read from the cache as needed.
        augmentation: random changes of training samples; None for none.
        seed: of the animals, the views, the order of training samples and the augmentation.
        sketches: a folder, a glob or a list of drawings, for predict.
        hints: folder of hint pictures for the drawings: normals painted on transparent PNGs.
    """

    def __init__(
        self,
        meshes: str | list[str] | None = None,
        animals: int = 24,
        orientation: str | None = None,
        crease_angle: float | None = None,
        split_file: str | None = None,
        fractions: tuple[float, float, float] = (0.7, 0.1, 0.2),
        split_seed: int = 0,
        views: Views = Views(),  # noqa: B008  # frozen
        renderer: Renderer = EmbreeRenderer(),  # noqa: B008
        lines: LineDrawing = SuggestiveContours(),  # noqa: B008
        size: int = 256,
        train_views: int = 100,
        val_views: int = 20,
        test_views: int = 20,
        cache: str = "cache",
        render_workers: int = 2,
        batch_size: int = 8,
        workers: int = 0,
        memory: int = 2 * 1024**3,
        augmentation: Augmentation | None = None,
        seed: int = 0,
        sketches: str | list[str] | None = None,
        hints: str | None = None,
    ) -> None:
        super().__init__()
        for name, number in {"animals": animals, "batch_size": batch_size}.items():
            if number < 1:
                raise InputError(f"data.{name} must be 1 or more, not {number}.")
        for name, number in {"render_workers": render_workers, "workers": workers, "memory": memory}.items():
            if number < 0:
                raise InputError(f"data.{name} must be 0 or more, not {number}.")
        self.meshes = meshes
        self.animals = animals
        self.orientation = orientation
        self.crease_angle = crease_angle
        self.split_file = split_file
        self.fractions = fractions
        self.split_seed = split_seed
        self.recipe = Recipe(views=views, renderer=renderer, lines=lines, size=size, seed=seed)
        self.views_per_mesh = {"train": train_views, "val": val_views, "test": test_views}
        self.cache = cache
        self.render_workers = render_workers
        self.batch_size = batch_size
        self.workers = workers
        self.memory = memory
        self.augmentation = augmentation
        self.seed = seed
        self.sketches = sketches
        self.hints = hints
        self._sketch_dataset: SketchDataset | None = None

    # --- from meshes to samples on disk ---------------------------------------------------------------

    @cached_property
    def sources(self) -> dict[str, list[MeshSource]]:
        """The meshes of each split.

        Raises:
            InputError: if a mesh, the split or the orientation cannot be used.
        """
        found = find_sources(self.meshes, self.animals, self.seed, self.orientation, self.crease_angle)
        return split_sources(found, self.split_file, self.fractions, self.split_seed)

    def prepare_data(self) -> None:
        """Render what is not in the cache yet; go on where it was interrupted."""
        if self.trainer is not None and self.trainer.predicting:
            return
        render_samples(self.cache, self.sources, self.views_per_mesh, self.recipe, self.render_workers)

    def setup(self, stage: str) -> None:
        """Read the drawings, or nothing: splits are opened when first asked for.

        Raises:
            InputError: if there are no drawings to predict, or one cannot be used.
        """
        if stage == "predict":
            if self.sketches is None:
                raise InputError("predict needs drawings: --data.sketches names a folder, a glob or a list.")
            self._sketch_dataset = SketchDataset(self.sketches, self.recipe.size, self.hints)

    @cached_property
    def train_dataset(self) -> SampleDataset:
        """Samples of the training meshes."""
        return self._open("train")

    @cached_property
    def val_dataset(self) -> SampleDataset:
        """Samples of the validation meshes."""
        return self._open("val")

    @cached_property
    def test_dataset(self) -> SampleDataset:
        """Samples of the test meshes."""
        return self._open("test")

    def _open(self, split: str) -> SampleDataset:
        stores = open_samples(self.cache, self.sources, self.views_per_mesh, self.recipe)
        return SampleDataset(stores[split], self.memory)

    # --- from samples to batches ----------------------------------------------------------------------

    def train_dataloader(self) -> DataLoader[Item]:
        """Return shuffled batches; the order depends on the seed and the epoch alone."""
        dataset = self.train_dataset
        # torch's DistributedSampler also serves a single process. Its order comes from its seed and the
        # epoch, which Lightning sets, and not from global state, which a resumed run does not have.
        sampler: DistributedSampler[Item] = DistributedSampler(
            dataset, *self._replicas_and_rank(), shuffle=True, seed=self.seed
        )
        whole = len(sampler) >= self.batch_size  # a last batch of one sample would upset batch norm
        return self._loader(dataset, sampler=sampler, drop_last=whole)

    def val_dataloader(self) -> DataLoader[Item]:
        """Return the validation samples in order."""
        return self._measured(self.val_dataset)

    def test_dataloader(self) -> DataLoader[Item]:
        """Return the test samples in order."""
        return self._measured(self.test_dataset)

    def predict_dataloader(self) -> DataLoader[SketchSample]:
        """Return the drawings in order."""
        dataset = self._drawings()
        # By name: Lightning builds the loader anew from its arguments when predicting.
        return DataLoader(dataset, batch_size=self.batch_size, collate_fn=collate_sketches)

    def _measured(self, dataset: SampleDataset) -> DataLoader[Item]:
        replicas, rank = self._replicas_and_rank()
        if replicas == 1:
            return self._loader(dataset)
        share = EqualShare(dataset, replicas, rank)
        return self._loader(share, sampler=share.in_order())

    def _replicas_and_rank(self) -> tuple[int, int]:
        return (self.trainer.world_size, self.trainer.global_rank) if self.trainer else (1, 0)

    def _loader(
        self, dataset: Dataset[Item], sampler: DistributedSampler[Item] | None = None, drop_last: bool = False
    ) -> DataLoader[Item]:
        return DataLoader(
            dataset,
            batch_size=self.batch_size,
            sampler=sampler,
            num_workers=self.workers,
            collate_fn=collate,
            drop_last=drop_last,
            persistent_workers=self.workers > 0,
            pin_memory=torch.cuda.is_available(),
        )

    def on_after_batch_transfer(self, batch: Batch, dataloader_idx: int) -> Batch:
        """Augment training batches, on the device they are on."""
        trainer = self.trainer
        if self.augmentation is None or trainer is None or not trainer.training:
            return batch
        step = trainer.fit_loop.total_batch_idx
        return self.augmentation(batch, derive_seed("augment", self.seed, step, trainer.global_rank))

    # --- what others ask ------------------------------------------------------------------------------

    def mean_normal_map(self) -> Tensor:
        """Return the mean of the training maps, (3, H, W) of unit length, 0 where no object ever is."""
        total = torch.zeros(3, self.recipe.size, self.recipe.size, dtype=torch.float64)
        for index in range(len(self.train_dataset)):
            total += self.train_dataset[index]["normal"]
        return unit_vectors(total[None])[0].float()

    def frame(self, name: str) -> Frame:
        """Return how the drawing of this name was framed for the model."""
        return self._drawings().frames[name]

    def _drawings(self) -> SketchDataset:
        if self._sketch_dataset is None:
            raise RuntimeError("the drawings are read in setup('predict').")
        return self._sketch_dataset
