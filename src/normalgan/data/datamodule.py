"""MeshDataModule: from meshes, animals or pairs to batches, and from drawings to be predicted."""

import hashlib
import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import Any

import torch
from lightning.pytorch import LightningDataModule
from lightning.pytorch.trainer.states import TrainerFn, TrainerStatus
from torch import Tensor
from torch.utils.data import DataLoader

from normalgan.animals import make_animals
from normalgan.batch import Batch
from normalgan.contracts import check_kinds, class_name, refused
from normalgan.data.augmentation import BatchAugmentation, augmented
from normalgan.data.dataset import SampleDataset
from normalgan.data.loading.items import Item, decode
from normalgan.data.loading.loaders import Loaders
from normalgan.data.loading.order import spread
from normalgan.data.loading.stream import StreamDataset
from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.render import find_unusable, leave_out, open_samples, render_samples
from normalgan.data.settings import EmbeddedAnimals, MeshOptions, MeshReading, Prediction, Split, Storage
from normalgan.data.sketches import SketchDataset, SketchSample
from normalgan.data.sources import DataSource, MeshGroup, PairSource, SplitSettings
from normalgan.data.sources.meshes import join_variants, split_meshes
from normalgan.data.sources.pair_files import PairFiles
from normalgan.data.splits import SPLITS
from normalgan.data.store.dataset_description import fingerprints, views_by_split
from normalgan.errors import InputError
from normalgan.inference.jobs.plan import find_files
from normalgan.line_widths import USUAL_WIDTHS
from normalgan.ranges import Count, PositiveInt, check_ranges
from normalgan.rendering import EmbreeRenderer, MeshSource, Renderer, Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import LineDrawing, SuggestiveContours
from normalgan.rendering.media import Medium
from normalgan.rendering.samples import Recipe
from normalgan.seeds import derive_seed
from normalgan.vectors import unit_vectors

__all__ = ["MeshDataModule"]

_MEAN_OF = 1024
"""Samples of an endless split that its mean is taken over; at each pixel its error is about 1/32."""
_SHORT = 40
"""Characters of a changed setting that a warning shows; of a longer one it only gives the name."""
_PER_SHARD = 32
_PAIRS_PER_SHARD = 8
"""Small, because reading one pair makes its whole shard."""


class MeshDataModule(LightningDataModule):
    """Makes or reads sketches, normal maps and masks, and serves them and drawings to predict in batches.

    Settings that researchers change from run to run are separate parameters, as in other data modules; the
    rest is grouped.

    Args:
        meshes: a folder, a glob or a list of mesh files (.off .obj .ply .stl .glb .gltf); None uses the
            embedded procedural animals, or the source.
        groups: groups of meshes with their own reading, poses and split, besides ``meshes`` or instead.
        source: where samples come from, such as `Pairs` on disk, instead of meshes and animals.
        reading: how ``meshes`` are read, and how many variants are made of each.
        animals: embedded animals, instead of meshes or in addition to them.
        split: which meshes are for training, validation and testing.
        views: where the objects are looked at from.
        renderer: renders a mesh to maps.
        lines: the style of the sketches.
        hand: how a person would draw these lines; None draws the exact ones.
        medium: pen, paper and scanner; None draws clean ink on white paper.
        size: side of the pictures in pixels.
        train_views: views of each training mesh; on the fly, of each epoch.
        val_views: views of each validation mesh.
        test_views: views of each test mesh.
        on_the_fly: render training samples in ``workers`` during training, with new views every epoch, and
            store none; otherwise they are rendered once and stored, as validation and test samples always
            are.
        cache: folder or URL where rendered samples are kept.
        storage: memory, disk and processes that this machine spends on samples.
        batch_size: samples in a batch.
        workers: processes that load samples, or render them on the fly; 0 does it in this one: enough for
            samples that fit in memory.
        augmentation: random changes of training samples; None for none.
        seed: seed of the animals, the views, the order of training samples and the augmentation.
        prediction: drawings, for predict.
    """

    def __init__(
        self,
        meshes: str | list[str] | None = None,
        groups: list[MeshGroup] = [],  # noqa: B006  # never changed
        source: DataSource | None = None,
        reading: MeshReading = MeshReading(),  # noqa: B008  # frozen, as are all below
        animals: EmbeddedAnimals = EmbeddedAnimals(),  # noqa: B008
        split: Split = Split(),  # noqa: B008
        views: Views = Views(),  # noqa: B008
        renderer: Renderer = EmbreeRenderer(),  # noqa: B008
        lines: LineDrawing = SuggestiveContours(),  # noqa: B008
        hand: Hand | None = None,
        medium: Medium | None = None,
        size: int = 256,
        train_views: int = 100,
        val_views: int = 20,
        test_views: int = 20,
        on_the_fly: bool = False,
        cache: str = "cache",
        storage: Storage = Storage(),  # noqa: B008
        batch_size: PositiveInt = 8,
        workers: Count = 0,
        augmentation: BatchAugmentation | None = None,
        seed: int = 0,
        prediction: Prediction = Prediction(),  # noqa: B008
    ) -> None:
        super().__init__()
        self._drawings: SketchDataset | None = None
        self._training_data: dict[str, Any] | None = None
        kinds: dict[str, tuple[object, type]] = {
            "data.views": (views, Views),
            "data.renderer": (renderer, Renderer),
            "data.lines": (lines, LineDrawing),
            "data.source": (source, DataSource),
            "data.hand": (hand, Hand),
            "data.medium": (medium, Medium),
            "data.augmentation": (augmentation, BatchAugmentation),
        }
        check_kinds(kinds, optional=["data.source", "data.hand", "data.medium", "data.augmentation"])
        self.meshes, self.groups, self.source = meshes, groups, source
        self.reading, self.animals, self.split = reading, animals, split
        self.recipe: SampleRecipe = Recipe(views, renderer, lines, size, seed, hand, medium)
        self.views_per_mesh = {"train": train_views, "val": val_views, "test": test_views}
        if source is not None:
            self.recipe, self.views_per_mesh = (
                source.recipe(self.recipe),
                dict(source.views(self.views_per_mesh)),
            )
        self.on_the_fly = on_the_fly
        self.cache, self.storage = cache, storage
        self.batch_size, self.workers = batch_size, workers
        self.augmentation = augmentation
        self.seed = seed
        self.prediction = prediction
        self._check_source()
        check_ranges(self)

    def _check_source(self) -> None:
        """Raise `InputError` if two settings say where the samples come from."""
        meshes, groups, source, extra = self.meshes, self.groups, self.source, self.animals.extra
        if extra and meshes is None and not groups:
            raise InputError(
                "data.animals.extra join meshes of yours, and data.meshes names none; data.animals.count "
                "says how many animals there are without."
            )
        given = {"meshes": meshes, "groups": groups, "animals.extra": extra}
        if source is not None and (named := [name for name, value in given.items() if value]):
            raise InputError(
                f"data.{named[0]} says that the data are meshes, and data.source names "
                f"{type(source).__name__}; leave one of them out."
            )
        if self.on_the_fly and self.of_pairs:
            raise InputError(
                f"data.on_the_fly renders meshes while training, but {type(source).__name__} has "
                "pairs, which are read once and kept; leave it out."
            )

    # --- what there is --------------------------------------------------------------------------------

    @property
    def of_pairs(self) -> bool:
        """Whether the samples are pairs on disk: each is named after its files and has one view."""
        return isinstance(self.source, PairSource)

    @cached_property
    def sources(self) -> dict[str, Sequence[Loadable]]:
        """What each split holds: meshes, or the pairs of a source.

        Raises:
            InputError: if a mesh, a pair, the split or the orientation cannot be used.
        """
        how = (self.split.fractions, self.split.seed, self.split.file)
        settings = SplitSettings(*how, data_seed=self.seed, variation=self.reading.variation)
        if self.source is None:
            return self._meshes(settings)
        found: object = self.source.split(settings)
        if not isinstance(found, Mapping):
            raise refused(self.source, found, "a data source gives what there is by the name of the split")
        if unknown := set(found) - set(SPLITS):
            raise InputError(
                f"{class_name(self.source)} has a split {min(unknown)!r}; the splits are {', '.join(SPLITS)}."
            )
        sources: dict[str, Sequence[Loadable]] = {split: list(found.get(split, [])) for split in SPLITS}
        for source in (each for part in sources.values() for each in part):
            if not isinstance(source, Loadable):
                raise refused(self.source, source, "a mesh or pair has a name, fingerprint() and load()")
        return sources

    def _meshes(self, settings: SplitSettings) -> dict[str, Sequence[Loadable]]:
        """Return the default source: meshes, groups of them, or the embedded animals."""
        kinds = [group.split(settings) for group in self.groups]
        reading, animals = self.reading, self.animals
        if self.meshes is not None:
            how = {option.name: getattr(reading, option.name) for option in fields(MeshOptions)}
            group = MeshGroup(self.meshes, split_file=self.split.file, **how)
            kinds = [group.split(settings), *kinds]
        elif not self.groups:
            own: list[MeshSource] = [*make_animals(animals.count, self.seed, list(animals.species))]
            made = split_meshes(own, settings)
            varied = join_variants(made["train"], settings.variation, reading.variants)
            kinds = [made | {"train": varied}]
        how_many = (animals.extra, self.seed, list(animals.species), animals.extra_postures)
        extra = make_animals(*how_many) if animals.extra else []
        joined = {split: [mesh for kind in kinds for mesh in kind[split]] for split in SPLITS}
        return {**joined, "train": [*joined["train"], *extra]}

    @property
    def kept(self) -> dict[str, Sequence[Loadable]]:
        """The splits that are stored: all, or all but the training split if it is rendered on the fly."""
        return {
            name: part for name, part in self.sources.items() if not (self.on_the_fly and name == "train")
        }

    # --- from meshes to samples -----------------------------------------------------------------------

    def prepare_data(self) -> None:
        """Render the stored samples that are not in the cache yet."""
        if self.trainer is None or not self.trainer.predicting:
            self.render(thorough=False)

    def render(self, cluster: str | None = None, thorough: bool = True) -> None:
        """Render as `prepare_data` does.

        Args:
            cluster: a Dask cluster to render on instead of this machine.
            thorough: whether to also check every byte in a remote store, and to retry failed meshes.
        """
        views_by_split(self.views_per_mesh, self.sources)  # raises errors before training starts
        if any(self.kept.values()):
            render_samples(
                *(self.cache, self.kept, self.views_per_mesh, self.recipe, self.storage.render_workers),
                cluster=cluster,
                thorough=thorough,
                per_shard=_PAIRS_PER_SHARD if self.of_pairs else _PER_SHARD,
                later=self._later(),
            )
        if self.on_the_fly:
            reasons = find_unusable(self.cache, self.sources["train"], self.storage.render_workers)
            for name, reason in reasons.items():
                warnings.warn(f"the {self.recipe.noun} {name} is left out: {reason}", stacklevel=2)
            leave_out(self.sources["train"], reasons, "train", self.recipe.noun)

    def _later(self) -> list[str]:
        """Return the splits whose samples are made when they are first read.

        In training this applies to pairs, so that it begins at once. A split that is measured is made first.
        """
        stage = self.trainer.state.fn if self.trainer is not None else None
        measured = {TrainerFn.FITTING: "", TrainerFn.VALIDATING: "val", TrainerFn.TESTING: "test"}
        if not self.of_pairs or stage not in measured:
            return []
        return [split for split in SPLITS if split != measured[stage]]

    def setup(self, stage: str) -> None:
        """Read the drawings, or record the training data; splits are opened on first use.

        Raises:
            InputError: if there are no drawings to predict, or one cannot be used.
        """
        if stage == "fit":
            self._training_data = self._describe_training_data()
        if stage == "predict":
            asked = self.prediction
            if asked.sketches is None:
                raise InputError(
                    "predict needs drawings: --data.prediction.sketches names a folder, a glob or a list."
                )
            files = find_files(asked.sketches, hints=asked.hints, mask=asked.mask)
            model = self.trainer.lightning_module if self.trainer is not None else None
            widths = getattr(model, "line_widths", USUAL_WIDTHS)  # another author's module does not have it
            self._drawings = SketchDataset(files, self.recipe.size, asked.map_size, widths)

    def _describe_training_data(self) -> dict[str, Any]:
        """Return all that decides which training samples come when, by setting, as plain values for JSON."""
        recipe = self.recipe.describe()
        meshes = json.dumps(fingerprints({"train": self.sources["train"]}))
        version = recipe.pop("rendering_version")
        described = {
            "data.meshes": hashlib.sha256(meshes.encode()).hexdigest(),
            "data.train_views": self.views_per_mesh["train"],
            "data.on_the_fly": self.on_the_fly,
            "data.batch_size": self.batch_size,
            "data.augmentation": self.augmentation.describe() if self.augmentation else None,
            **{f"data.{name}": value for name, value in recipe.items()},
            "the number of processes": self.trainer.world_size if self.trainer else 1,
            "the version of the rendering": version,
        }
        plain: dict[str, Any] = json.loads(json.dumps(described))  # lists, not tuples, as in a checkpoint
        return plain

    def state_dict(self) -> dict[str, Any]:
        """Return the settings that the training samples depend on, for a checkpoint."""
        return {"training_data": self._training_data} if self._training_data else {}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Warn if a resumed run was trained with different samples or in a different order."""
        before = state_dict.get("training_data")
        if self._training_data and before and (changed := _changes(before, self._training_data)):
            warnings.warn(
                f"the checkpoint was trained with other data, and goes on with what is given now: {changed}.",
                stacklevel=2,
            )

    @cached_property
    def train_dataset(self) -> SampleDataset | StreamDataset:
        """Samples of the training meshes; on the fly, indices are those of the first epoch."""
        if not self.on_the_fly:
            return self._open("train")
        sources = self.sources["train"]
        usable = leave_out(sources, find_unusable(self.cache, sources), "train", self.recipe.noun)
        memory = self.storage.memory // max(self.workers, 1)
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
        if not self.kept[split]:
            remedy = "give it a share in data.split.fractions, or names in data.split.file"
            pairs = [item for items in self.sources.values() for item in items if isinstance(item, PairFiles)]
            if any(pair.part is not None for pair in pairs):
                remedy = (
                    f"the folders or the CSV of the pairs give the splits: put pairs into {split} there, or "
                    "pass --data.source.resplit true to split all pairs by data.split.fractions"
                )
            raise InputError(f"the split {split} is empty, but it is needed; {remedy}.")
        # An unusable training pair keeps its place, whenever it is found, so that a resumed run, which
        # knows it from the start, has the same order.
        later = {*self._later(), *(["train"] if self.of_pairs else [])}
        stores = open_samples(self.cache, self.kept, self.views_per_mesh, self.recipe, later=later)
        substitute = self.of_pairs and split == "train"
        return SampleDataset(stores[split], self.storage.memory, max(self.workers, 1), substitute)

    # --- from samples to batches ----------------------------------------------------------------------

    def train_dataloader(self) -> DataLoader[Item]:
        """Return shuffled batches; the order depends only on the seed and the epoch."""
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
        # By name, because Lightning rebuilds the loader from its arguments when predicting.
        return DataLoader(dataset, batch_size=self.batch_size)

    def _loaders(self) -> Loaders:
        replicas, rank = (self.trainer.world_size, self.trainer.global_rank) if self.trainer else (1, 0)
        # A trainer at work has its batches decoded by `on_after_batch_transfer`.
        at_work = self.trainer is not None and self.trainer.state.status == TrainerStatus.RUNNING
        return Loaders(self.batch_size, self.workers, replicas, rank, decoded=not at_work)

    def on_after_batch_transfer(self, batch: Batch, dataloader_idx: int) -> Batch:
        """Decode batches on their device, and augment training batches there.

        Drawings to predict are decoded already.
        """
        trainer = self.trainer
        if "normal" in batch:
            batch = decode(batch)
        if self.augmentation is None or trainer is None or not trainer.training:
            return batch
        step = trainer.fit_loop.total_batch_idx
        seed = derive_seed("augment", self.seed, step, trainer.global_rank)
        return augmented(self.augmentation, batch, seed)

    # --- what others ask ------------------------------------------------------------------------------

    def mean_normal_map(self) -> Tensor:
        """Return the mean of the training maps, (3, H, W) of unit length, 0 where no object ever is.

        On the fly it is taken over views of the first epoch: all of them, or 1024 spread evenly.
        """
        dataset = self.train_dataset
        count = len(dataset)
        indices = spread(count, _MEAN_OF) if self.on_the_fly else range(count)
        total = torch.zeros(1, 3, self.recipe.size, self.recipe.size, dtype=torch.float64)
        for batch in self._loaders().chosen(dataset, indices):
            total += decode(batch)["normal"].double().sum(dim=0)
        return unit_vectors(total)[0].float()

    @property
    def drawings(self) -> SketchDataset:
        """The drawings to predict, once `setup` has read them."""
        if self._drawings is None:
            raise RuntimeError("the drawings are read in setup('predict').")
        return self._drawings


def _changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the settings that have changed; empty if nothing.

    >>> before = {"data.batch_size": 8, "data.meshes": "0f" * 32, "data.size": 64}
    >>> _changes(before, {"data.batch_size": 4, "data.meshes": "1e" * 32, "data.size": 64})
    'data.batch_size (8, now 4), data.meshes'
    """
    changed = [name for name in before if before[name] != now.get(name)]
    shown = {name: f"{json.dumps(before[name])}, now {json.dumps(now.get(name))}" for name in changed}
    return ", ".join(f"{name} ({shown[name]})" if len(shown[name]) <= _SHORT else name for name in changed)
