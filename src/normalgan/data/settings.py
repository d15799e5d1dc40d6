"""DataSettings: what samples there are, as a user sets it, checked."""

from functools import cached_property

from lightning.pytorch import LightningDataModule

from normalgan.animals import herd
from normalgan.data.augmentation import Augmentation
from normalgan.data.groups import MeshGroup
from normalgan.data.local_cache import LocalCache
from normalgan.data.sources import join_variants, split_sources
from normalgan.data.splits import SPLITS
from normalgan.errors import InputError
from normalgan.rendering import EmbreeRenderer, MeshSource, Renderer, Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import LineDrawing, SuggestiveContours
from normalgan.rendering.media import Medium
from normalgan.rendering.samples import Recipe
from normalgan.rendering.variation import Variation


class DataSettings(LightningDataModule):
    """The settings of the data, and what follows from them at once: recipe, and meshes of each split.

    Args:
        meshes: a folder, a glob or a list of mesh files (.off .obj .ply .stl .glb .gltf); None takes the
            embedded procedural animals.
        groups: kinds of meshes that are read, posed and split each in its own way, besides ``meshes`` or in
            place of them.
        animals: how many embedded animals there are, if no meshes are given.
        extra_animals: embedded animals that join the training meshes that are given; those to validate and
            test stay as they are.
        species: groups (such as quadrupeds or birds) and species that the embedded animals are of, in turn.
        poses: of each rigged glTF file, in place of it at rest; 0 leaves all files at rest.
        variants: individuals that join each training mesh, varied at random; those to validate and test stay
            as they are.
        variation: how far such individuals differ from the mesh.
        orientation: JSON file that says of each mesh how it is turned upright, and whether inside out.
        crease_angle: degrees from which an edge is sharp; None shades everything smooth.
        split_file: JSON file that lists the train, val and test meshes; None splits by fractions.
        fractions: shares of train, val and test meshes, if there is no split file.
        split_seed: which meshes go where, if there is no split file.
        views: where the objects are looked at from.
        renderer: what turns a mesh and a camera into maps.
        lines: the style of the sketches.
        hand: how a person would draw these lines; None draws the exact ones.
        medium: pen, paper and scanner; None is clean ink on white paper.
        size: side of the pictures in pixels.
        train_views: views of each training mesh; on the fly, of each epoch.
        val_views: views of each validation mesh.
        test_views: views of each test mesh.
        on_the_fly: render training samples while training, in ``workers``, other views every epoch, and
            keep none; if not, they are rendered once and kept, as those to validate and test always are.
        cache: folder or URL where rendered samples are kept.
        local_cache: folder on this machine for shards of a cache behind a URL, so that each is fetched once;
            None fetches what is wanted each time. A cache on this machine needs none.
        local_cache_size: bytes that may be used there.
        render_workers: processes that render what is kept, side by side; 0 renders in this one.
        batch_size: samples a batch.
        workers: processes that load samples, or render them on the fly; 0 does it in this one: enough for
            samples that fit in memory.
        memory: bytes that a split may take in memory; larger ones are read from the cache as needed. On the
            fly, what the meshes may take in all workers together.
        augmentation: random changes of training samples; None for none.
        seed: of the animals, the views, the order of training samples and the augmentation.
        sketches: a folder, a glob or a list of drawings, for predict.
        hints: hints for the drawings: a file, or a folder of ``<sketch>_hints.png`` or ``.json``.
        mask: where the object is in the drawings: a file, a folder of ``<sketch>_mask.png``, ``outline`` to
            fill the drawing's own, or ``model`` to leave it to the model; None is its opacity if that tells,
            else its outline.
        map_size: longer side of the maps in pixels; None is the drawing's, 1024 of an SVG.
    """

    def __init__(
        self,
        meshes: str | list[str] | None = None,
        groups: list[MeshGroup] = [],  # noqa: B006  # never changed
        animals: int = 24,
        extra_animals: int = 0,
        species: list[str] = ["quadrupeds"],  # noqa: B006  # never changed
        poses: int = 0,
        variants: int = 0,
        variation: Variation = Variation(),  # noqa: B008  # frozen
        orientation: str | None = None,
        crease_angle: float | None = None,
        split_file: str | None = None,
        fractions: tuple[float, float, float] = (0.7, 0.1, 0.2),
        split_seed: int = 0,
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
        local_cache: str | None = None,
        local_cache_size: int = 20 * 10**9,
        render_workers: int = 2,
        batch_size: int = 8,
        workers: int = 0,
        memory: int = 2 * 1024**3,
        augmentation: Augmentation | None = None,
        seed: int = 0,
        sketches: str | list[str] | None = None,
        hints: str | None = None,
        mask: str | None = None,
        map_size: int | None = None,
    ) -> None:
        super().__init__()
        for name, number in {"animals": animals, "batch_size": batch_size}.items():
            if number < 1:
                raise InputError(f"data.{name} must be 1 or more, not {number}.")
        if extra_animals and meshes is None and not groups:
            raise InputError(
                "data.extra_animals join meshes of yours, and data.meshes names none; data.animals says how "
                "many animals there are without."
            )
        counts = {"extra_animals": extra_animals, "poses": poses, "variants": variants, "memory": memory}
        for name, number in (counts | {"render_workers": render_workers, "workers": workers}).items():
            if number < 0:
                raise InputError(f"data.{name} must be 0 or more, not {number}.")
        self.meshes = meshes
        self.groups = groups
        self.animals = animals
        self.extra_animals = extra_animals
        self.species = species
        self.poses = poses
        self.variants = variants
        self.variation = variation
        self.orientation = orientation
        self.crease_angle = crease_angle
        self.split_file = split_file
        self.fractions = fractions
        self.split_seed = split_seed
        self.recipe = Recipe(views, renderer, lines, size, seed, hand, medium)
        self.views_per_mesh = {"train": train_views, "val": val_views, "test": test_views}
        self.on_the_fly = on_the_fly
        self.cache = cache
        self.nearby = LocalCache(local_cache, local_cache_size) if local_cache else None
        self.render_workers = render_workers
        self.batch_size = batch_size
        self.workers = workers
        self.memory = memory
        self.augmentation = augmentation
        self.seed = seed
        self.sketches = sketches
        self.hints = hints
        self.mask = mask
        self.map_size = map_size

    @cached_property
    def sources(self) -> dict[str, list[MeshSource]]:
        """The meshes of each split.

        Raises:
            InputError: if a mesh, the split or the orientation cannot be used.
        """
        kinds = [each.sources(self.fractions, self.split_seed, self.variation) for each in self.groups]
        if self.meshes is not None or not self.groups:
            kinds = [self._ungrouped(), *kinds]
        extra = herd(self.extra_animals, self.seed, self.species) if self.extra_animals else []
        joined = {split: [mesh for kind in kinds for mesh in kind[split]] for split in SPLITS}
        return joined | {"train": [*joined["train"], *extra]}

    def _ungrouped(self) -> dict[str, list[MeshSource]]:
        """Return the meshes that belong to no group, or the embedded animals, by split."""
        if self.meshes is not None:
            alone = MeshGroup(
                *(
                    self.meshes,
                    self.orientation,
                    self.crease_angle,
                    self.poses,
                    self.variants,
                    self.split_file,
                )
            )
            return alone.sources(self.fractions, self.split_seed, self.variation)
        animals = [*herd(self.animals, self.seed, self.species)]
        split = split_sources(animals, self.split_file, self.fractions, self.split_seed)
        return split | {"train": join_variants(split["train"], self.variation, self.variants)}

    @property
    def kept(self) -> dict[str, list[MeshSource]]:
        """The meshes of the splits whose samples are kept: all, or all but those to train on the fly."""
        return {
            name: part for name, part in self.sources.items() if not (self.on_the_fly and name == "train")
        }
