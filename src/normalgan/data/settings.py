"""Grouped settings of the data module: reading and splitting of meshes, animals, storage, prediction."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from normalgan.data.splits import split_by_file, split_by_fractions
from normalgan.errors import InputError
from normalgan.ranges import Count, PositiveInt, UnitInterval, check_ranges
from normalgan.rendering.variation import Variation


@dataclass(frozen=True, kw_only=True)
class MeshOptions:
    """Options for reading mesh files and for adding poses and variants.

    Args:
        orientation: JSON file with the rotation that makes each mesh upright, and whether it is inside
            out.
        crease_angle: angle in degrees from which an edge is sharp; None uses smooth shading everywhere.
        poses: number of poses that replace each rigged glTF file; 0 keeps all files in their rest pose.
        variants: number of random variants added for each training mesh or embedded animal; validation and
            test meshes are not changed.
    """

    orientation: str | None = None
    crease_angle: float | None = None
    poses: Count = 0
    variants: Count = 0

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, kw_only=True)
class MeshReading(MeshOptions):
    """Options for reading the meshes that are not in a group.

    Args:
        variation: how much variants differ from their mesh, including those in groups.
    """

    variation: Variation = Variation()  # noqa: RUF009  # frozen


@dataclass(frozen=True)
class EmbeddedAnimals:
    """Animals that the package generates.

    Args:
        count: number of animals, if no meshes are given.
        extra: number of animals added to the given training meshes; validation and test meshes are not
            changed.
        extra_postures: fraction of the extra animals that sit, lie, rear, beg, bow, leap or look back, if
            the species has such a pose.
        species: groups (such as quadrupeds or birds) and species to generate in turn.
    """

    count: PositiveInt = 24
    extra: Count = 0
    extra_postures: UnitInterval = 0.0
    species: tuple[str, ...] = ("quadrupeds",)

    def __post_init__(self) -> None:
        check_ranges(self)
        species: object = self.species
        if isinstance(species, str):  # a single string would be read letter by letter
            raise InputError(
                f"data.animals.species is a list of names, such as [{species!r}], not {species!r}."
            )


@dataclass(frozen=True)
class Split:
    """Assignment of meshes or pairs to training, validation and testing.

    Args:
        fractions: fractions of train, val and test, used if there is no file.
        seed: seed of the random split, used if there is no file.
        file: JSON file that lists the names in train, val and test; None splits by fractions.
    """

    fractions: tuple[float, float, float] = (0.7, 0.1, 0.2)
    seed: int = 0
    file: str | None = None

    def deal(self, names: Sequence[str], noun: str = "mesh") -> dict[str, list[str]]:
        """Return the names in each split, from the file or, without a file, by fractions.

        Args:
            names: names of meshes, pairs or groups of pairs, which are not divided.
            noun: word for one of them in messages.

        Raises:
            InputError: if the file or the fractions are invalid.
        """
        if self.file is None:
            return split_by_fractions(names, self.fractions, self.seed, noun)
        return split_by_file(Path(self.file), names, noun)


@dataclass(frozen=True)
class Storage:
    """Resources of this machine, which do not affect the samples.

    Args:
        memory: maximum memory for a split in bytes; larger splits are read from the cache as needed. When
            rendering on the fly, maximum memory for the meshes in all workers together.
        render_workers: number of processes that render stored samples in parallel; 0 renders in the main
            process.
    """

    memory: Count = 2 * 1024**3
    render_workers: Count = 2

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True)
class Prediction:
    """Drawings to predict, with their hints and masks.

    Args:
        sketches: folder, glob or list of drawings.
        hints: hints for the drawings: a file, or a folder of ``<sketch>_hints.png`` or ``.json``.
        mask: object masks of the drawings: a file, a folder of ``<sketch>_mask.png``, ``outline`` to fill
            the areas enclosed by lines, ``reader`` to also use a small segmentation network, or ``model``
            to use the generator's own segmentation. None uses the drawing's opacity if it shows the
            object, otherwise ``reader``.
        map_size: longer side of the maps in pixels; None uses the size of the drawing, or 1024 for an SVG.
    """

    sketches: str | list[str] | None = None
    hints: str | None = None
    mask: str | None = None
    map_size: int | None = None
