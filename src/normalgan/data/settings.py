"""Settings of the data module in groups: how meshes are read and split, animals, storage, prediction."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from normalgan.data.splits import split_by_file, split_by_fractions
from normalgan.errors import InputError
from normalgan.ranges import Count, PositiveInt, Share, check_ranges
from normalgan.rendering.variation import Variation

__all__ = ["EmbeddedAnimals", "MeshOptions", "MeshReading", "Prediction", "Split", "Storage"]


@dataclass(frozen=True, kw_only=True)
class MeshOptions:
    """How mesh files are read, and how many samples are made of each.

    Args:
        orientation: JSON file that says of each mesh how it is turned upright, and whether inside out.
        crease_angle: degrees from which an edge is sharp; None shades everything smooth.
        poses: poses that replace each rigged glTF file; 0 keeps all files at rest.
        variants: random variants added for each training mesh or embedded animal; validation
            and test meshes do not change.

    Raises:
        InputError: if a number is out of its range.
    """

    orientation: str | None = None
    crease_angle: float | None = None
    poses: Count = 0
    variants: Count = 0

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True, kw_only=True)
class MeshReading(MeshOptions):
    """How the meshes that are in no group are read.

    Args:
        variation: how much variants, those of groups too, differ from their mesh.
    """

    variation: Variation = Variation()  # noqa: RUF009  # frozen


@dataclass(frozen=True)
class EmbeddedAnimals:
    """Animals that the package generates.

    Args:
        count: number of animals, if no meshes are given.
        extra: number of animals added to the given training meshes; validation and test meshes do not change.
        extra_postures: share of the extra ones that sit, lie, rear, beg, bow, leap or look back, if the
            species has such a pose.
        species: groups (such as quadrupeds or birds) and species that they are of, in turn.
    """

    count: PositiveInt = 24
    extra: Count = 0
    extra_postures: Share = 0.0
    species: tuple[str, ...] = ("quadrupeds",)

    def __post_init__(self) -> None:
        check_ranges(self)
        species: object = self.species
        if isinstance(species, str):  # Python would read a lone name letter by letter
            raise InputError(
                f"data.animals.species is a list of names, such as [{species!r}], not {species!r}."
            )


@dataclass(frozen=True)
class Split:
    """Which meshes or pairs are for training, validation and testing.

    Args:
        fractions: shares of train, val and test, used if there is no file.
        seed: seed of the random split, used if there is no file.
        file: JSON file that lists the names of train, val and test; None splits by fractions.
    """

    fractions: tuple[float, float, float] = (0.7, 0.1, 0.2)
    seed: int = 0
    file: str | None = None

    def deal(self, names: Sequence[str], noun: str = "mesh") -> dict[str, list[str]]:
        """Return the names in each split: as the file lists them or, without one, by fractions.

        Args:
            names: names of meshes, pairs or groups of pairs, each of which stays in one split.
            noun: the word for one in messages.

        Raises:
            InputError: if the file or the fractions cannot be used.
        """
        if self.file is None:
            return split_by_fractions(names, self.fractions, self.seed, noun)
        return split_by_file(Path(self.file), names, noun)


@dataclass(frozen=True)
class Storage:
    """Resources of this machine; they do not change the samples.

    Args:
        memory: bytes that a split may take in memory; larger ones are read from the cache as needed. On the
            fly, bytes for the meshes in all workers together.
        render_workers: processes that render stored samples in parallel; 0 renders in this one.
    """

    memory: Count = 2 * 1024**3
    render_workers: Count = 2

    def __post_init__(self) -> None:
        check_ranges(self)


@dataclass(frozen=True)
class Prediction:
    """Drawings to predict, with their hints and masks.

    Args:
        sketches: a folder, a glob or a list of drawings.
        hints: hints for the drawings: a file, or a folder of ``<sketch>_hints.png`` or ``.json``.
        mask: where the object is in the drawings: a file, a folder of ``<sketch>_mask.png``, ``outline`` to
            fill what lines enclose, ``reader`` to let a small network vote on that, or ``model`` to leave it
            to the model; None uses its opacity if it shows the object, else the reader.
        map_size: longer side of the maps in pixels; None takes the drawing's, or 1024 for an SVG.
    """

    sketches: str | list[str] | None = None
    hints: str | None = None
    mask: str | None = None
    map_size: int | None = None
