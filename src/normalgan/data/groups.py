"""MeshGroup: meshes that are read alike, for data sets of several kinds of subject."""

from dataclasses import dataclass

from normalgan.data.sources import join_variants, pose, split_sources
from normalgan.errors import InputError
from normalgan.rendering import MeshSource, find_meshes
from normalgan.rendering.variation import Variation


@dataclass(frozen=True)
class MeshGroup:
    """Meshes of one kind: where they are, how they are read, and how many samples are made of them.

    A group is split by itself, so that every kind has its share in each split. As all training meshes get
    equally many views, poses and variants decide how much of a kind there is.

    Args:
        meshes: a folder, a glob or a list of mesh files.
        orientation: JSON file that says of each mesh how it is turned upright, and whether inside out.
        crease_angle: degrees from which an edge is sharp; None shades everything smooth.
        poses: of each rigged glTF file, in place of it at rest; 0 leaves all files at rest.
        variants: individuals that join each training mesh, varied at random.
        split_file: JSON file that lists the group's train, val and test meshes; None splits by fractions.

    Raises:
        InputError: if a number is negative.
    """

    meshes: str | list[str]
    orientation: str | None = None
    crease_angle: float | None = None
    poses: int = 0
    variants: int = 0
    split_file: str | None = None

    def __post_init__(self) -> None:
        for name in ("poses", "variants"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} of a group of meshes is {getattr(self, name)}; give 0 or more.")

    def sources(
        self, fractions: tuple[float, float, float], split_seed: int, variation: Variation
    ) -> dict[str, list[MeshSource]]:
        """Return the group's meshes by split.

        Args:
            fractions: shares of train, val and test, if the group has no split file.
            split_seed: which meshes go where, if it has none.
            variation: how far variants differ from their mesh.

        Raises:
            InputError: if a mesh, the split or the orientation cannot be used.
        """
        found = find_meshes(self.meshes, self.orientation, self.crease_angle)
        split = split_sources(found, self.split_file, fractions, split_seed)
        # After the split: poses and variants of one mesh are too much alike to be on both sides of it.
        posed = {name: pose(part, self.poses) for name, part in split.items()}
        return posed | {"train": join_variants(posed["train"], variation, self.variants)}
