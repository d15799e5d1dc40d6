"""MeshDataModule: batches of samples from meshes, animals or pairs, and of drawings to predict."""

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
from normalgan.data.store.manifest import fingerprints, views_by_split
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

_MEAN_OF = 1024
"""Number of samples for the mean map of an endless split, with an error of about 1/32 at each pixel."""
_SHORT = 40
"""Maximum length of a changed setting in a warning; for longer ones, only the name is shown."""
_PER_SHARD = 32
_PAIRS_PER_SHARD = 8
"""Samples per shard of pairs; small, because reading one pair creates its whole shard."""


class MeshDataModule(LightningDataModule):
    """Serves batches of sketches, normal maps and masks, rendered or read, and of drawings to predict.

    Settings that researchers often change are separate parameters, as in other data modules. The others
    are grouped.

    Args:
        meshes: folder, glob or list of mesh files (.off .obj .ply .stl .glb .gltf); None uses the embedded
            procedural animals, or the source.
        groups: groups of meshes with their own reading, poses and split, in addition to ``meshes`` or
            instead of them.
        source: data source, such as `Pairs` on disk, instead of meshes and animals.
        reading: how ``meshes`` are read, and the number of variants of each mesh.
        animals: embedded animals, instead of meshes or in addition to them.
        split: assignment of meshes to training, validation and testing.
        views: distribution of camera views.
        renderer: renderer of the meshes.
        lines: line style of the sketches.
        hand: model of a person's drawing hand; None draws exact lines.
        medium: pen, paper and scanner; None draws clean ink on white paper.
        size: side of the pictures in pixels.
        train_views: number of views per training mesh; on the fly, per epoch.
        val_views: number of views per validation mesh.
        test_views: number of views per test mesh.
        on_the_fly: whether to render training samples in ``workers`` during training, with new views every
            epoch and without storing them. Otherwise, they are rendered once and stored, as validation and
            test samples always are.
        cache: folder or URL where rendered samples are stored.
        storage: memory, disk and processes of this machine for samples.
        batch_size: number of samples in a batch.
        workers: number of processes that load samples, or render them on the fly. 0 uses only the main
            process, which is enough for samples that fit in memory.
        augmentation: random changes of training samples; None for no changes.
        seed: seed of the animals, the views, the order of training samples and the augmentation.
        prediction: drawings for ``predict``.
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
        """Raise `InputError` if two settings specify the source of the samples."""
        meshes, groups, source, extra = self.meshes, self.groups, self.source, self.animals.extra
        if extra and meshes is None and not groups:
            raise InputError(
                "data.animals.extra adds animals to your meshes, but data.meshes is not set; set it, or use "
                "data.animals.count instead."
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

    # --- sources --------------------------------------------------------------------------------

    @property
    def of_pairs(self) -> bool:
        """Whether the samples are pairs on disk, which are named after their files and have a single view."""
        return isinstance(self.source, PairSource)

    @cached_property
    def sources(self) -> dict[str, Sequence[Loadable]]:
        """The meshes, or the pairs of a source, by split.

        Raises:
            InputError: if a mesh, a pair, the split or the orientation is invalid.
        """
        how = (self.split.fractions, self.split.seed, self.split.file)
        settings = SplitSettings(*how, data_seed=self.seed, variation=self.reading.variation)
        if self.source is None:
            return self._meshes(settings)
        found: object = self.source.split(settings)
        if not isinstance(found, Mapping):
            raise refused(self.source, found, "a data source returns its items by the name of the split")
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
        """Return the items of the default source: meshes, groups of meshes, or embedded animals."""
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
        """The splits that are stored: all of them, except the training split if it is rendered on the fly."""
        return {
            name: part for name, part in self.sources.items() if not (self.on_the_fly and name == "train")
        }

    # --- from meshes to samples -----------------------------------------------------------------------

    def prepare_data(self) -> None:
        """Render all stored samples that are not in the cache yet."""
        if self.trainer is None or not self.trainer.predicting:
            self.render(thorough=False)

    def render(self, cluster: str | None = None, thorough: bool = True) -> None:
        """Render the samples, like `prepare_data`.

        Args:
            cluster: Dask cluster to render on instead of this machine.
            thorough: whether to check every byte in a remote store too, and to retry failed meshes.
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
        """Return the splits with samples that are created on first read.

        For pairs, these are all splits except the one that is measured, so training begins immediately.
        There are none for meshes, and none unless a trainer fits, validates or tests.
        """
        stage = self.trainer.state.fn if self.trainer is not None else None
        measured = {TrainerFn.FITTING: "", TrainerFn.VALIDATING: "val", TrainerFn.TESTING: "test"}
        if not self.of_pairs or stage not in measured:
            return []
        return [split for split in SPLITS if split != measured[stage]]

    def setup(self, stage: str) -> None:
        """Read the drawings, or record the training data; splits are opened on first use.

        Raises:
            InputError: if there are no drawings to predict, or one of them is invalid.
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
            widths = getattr(model, "line_widths", USUAL_WIDTHS)  # a third-party model may lack it
            self._drawings = SketchDataset(files, self.recipe.size, asked.map_size, widths)

    def _describe_training_data(self) -> dict[str, Any]:
        """Return all settings that determine the sequence of training samples, as plain values for JSON."""
        recipe = self.recipe.describe()
        meshes = json.dumps(fingerprints({"train": self.sources["train"]}))
        version = recipe.pop("rendering_version")
        described = {
            "data.meshes": hashlib.sha256(meshes.encode()).hexdigest(),
            "data.train_views": self.views_per_mesh["train"],
            "data.on_the_fly": self.on_the_fly,
            "data.batch_size": self.batch_size,
            "data.augmentation": self.augmentation.describe() if self.augmentation else None,
            "data.seed": self.seed,  # of the order; a recipe of pairs has no seed
            **{f"data.{name}": value for name, value in recipe.items()},
            "the number of processes": self.trainer.world_size if self.trainer else 1,
            "the version of the rendering": version,
        }
        plain: dict[str, Any] = json.loads(json.dumps(described))  # lists, not tuples, as in a checkpoint
        return plain

    def state_dict(self) -> dict[str, Any]:
        """Return the settings that determine the training samples, for a checkpoint."""
        return {"training_data": self._training_data} if self._training_data else {}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Warn if a resumed run was trained with different samples or in a different order."""
        before = state_dict.get("training_data")
        if self._training_data and before and (changed := _changes(before, self._training_data)):
            warnings.warn(
                "the checkpoint was trained with other data; training continues with the current settings: "
                f"{changed}.",
                stacklevel=2,
            )

    @cached_property
    def train_dataset(self) -> SampleDataset | StreamDataset:
        """Samples of the training meshes; if rendered on the fly, the indices refer to the first epoch."""
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
            remedy = "give it a fraction in data.split.fractions, or names in data.split.file"
            pairs = [item for items in self.sources.values() for item in items if isinstance(item, PairFiles)]
            if any(pair.part is not None for pair in pairs):
                remedy = (
                    f"the folders or the CSV of the pairs give the splits: put pairs into {split} there, or "
                    "pass --data.source.resplit true to split all pairs by data.split.fractions"
                )
            raise InputError(f"the split {split} is empty, but it is needed; {remedy}.")
        # An unusable training pair keeps its index, so the order is the same in a resumed run, which knows
        # it from the start.
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
        # As keyword arguments, because Lightning rebuilds the loader from them when predicting.
        return DataLoader(dataset, batch_size=self.batch_size)

    def _loaders(self) -> Loaders:
        replicas, rank = (self.trainer.world_size, self.trainer.global_rank) if self.trainer else (1, 0)
        # With a running trainer, `on_after_batch_transfer` decodes the batches.
        at_work = self.trainer is not None and self.trainer.state.status == TrainerStatus.RUNNING
        return Loaders(self.batch_size, self.workers, replicas, rank, decoded=not at_work)

    def on_after_batch_transfer(self, batch: Batch, dataloader_idx: int) -> Batch:
        """Decode batches on their device, and augment training batches there.

        Drawings to predict are already decoded.
        """
        trainer = self.trainer
        if "normal" in batch:
            batch = decode(batch)
        if self.augmentation is None or trainer is None or not trainer.training:
            return batch
        step = trainer.fit_loop.total_batch_idx
        seed = derive_seed("augment", self.seed, step, trainer.global_rank)
        return augmented(self.augmentation, batch, seed)

    # --- for models and callbacks --------------------------------------------------------------------

    def mean_normal_map(self) -> Tensor:
        """Return the mean of the training maps (3, H, W), unit vectors, or 0 where there is never an object.

        If training samples are rendered on the fly, it is the mean over up to 1024 evenly spaced views of
        the first epoch.
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
    """Return the changed settings as text, or "" if there are none.

    >>> before = {"data.batch_size": 8, "data.meshes": "0f" * 32, "data.size": 64}
    >>> _changes(before, {"data.batch_size": 4, "data.meshes": "1e" * 32, "data.size": 64})
    'data.batch_size (8, now 4), data.meshes'
    """
    changed = [name for name in before if before[name] != now.get(name)]
    shown = {name: f"{json.dumps(before[name])}, now {json.dumps(now.get(name))}" for name in changed}
    return ", ".join(f"{name} ({shown[name]})" if len(shown[name]) <= _SHORT else name for name in changed)
