"""Groups of mesh files, each with its own reading, poses, variants and split."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from normalgan.data.settings import MeshOptions
from normalgan.data.sources.base import SplitSettings
from normalgan.data.splits import SPLITS
from normalgan.ranges import UnitInterval
from normalgan.rendering import MeshSource, find_meshes
from normalgan.rendering.rigs import find_poses
from normalgan.rendering.variation import Variation, Varied

M = TypeVar("M", bound=MeshSource)


@dataclass(frozen=True)
class MeshGroup(MeshOptions):
    """A group of mesh files with their own reading options, poses and variants.

    Each group is split separately, so that it is represented in each split. All training meshes get the
    same number of views, so the weight of a group depends on its poses and variants.

    Args:
        meshes: folder, glob or list of mesh files.
        split_file: JSON file that lists the group's train, val and test meshes; None splits by fractions.
        postures: fraction of the training poses, from 0 to 1, that are postures such as sitting, lying or
            rearing, for known skeletons. The other poses come from animations.
    """

    meshes: str | list[str]
    split_file: str | None = None
    postures: UnitInterval = 0.0

    def split(self, settings: SplitSettings) -> dict[str, list[MeshSource]]:
        """Return the group's meshes by split.

        Raises:
            InputError: if a mesh, the split or the orientation is invalid.
        """
        found = find_meshes(self.meshes, self.orientation, self.crease_angle)
        split = split_meshes(found, replace(settings, file=self.split_file))
        # After the split, because similar poses and variants of a mesh must not be on both sides.
        # Validation and test meshes keep their poses, so that metrics stay comparable.
        posed: dict[str, list[MeshSource]] = {
            name: [*find_poses(part, self.poses, self.postures if name == "train" else 0.0)]
            for name, part in split.items()
        }
        return posed | {"train": join_variants(posed["train"], settings.variation, self.variants)}


def split_meshes(sources: Sequence[M], settings: SplitSettings) -> dict[str, list[M]]:
    """Return the meshes of each split.

    Raises:
        InputError: if the split is invalid.
    """
    by_name = {source.name: source for source in sources}
    names = settings.deal([source.name for source in sources])
    return {split: [by_name[name] for name in names[split]] for split in SPLITS}


def join_variants(sources: Sequence[MeshSource], variation: Variation, variants: int) -> list[MeshSource]:
    """Return each mesh, followed by ``variants`` random variants of it."""
    return [
        one
        for source in sources
        for one in (source, *(Varied(source, variation, number) for number in range(variants)))
    ]
