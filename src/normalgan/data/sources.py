"""Which meshes there are, and which split each belongs to."""

from collections.abc import Sequence
from pathlib import Path

from normalgan.data.splits import SPLITS, split_by_file, split_by_fractions
from normalgan.rendering import MeshFile, MeshSource
from normalgan.rendering.rigs import find_poses
from normalgan.rendering.variation import Variation, Varied


def split_sources(
    sources: Sequence[MeshSource], split_file: str | None, fractions: tuple[float, float, float], seed: int
) -> dict[str, list[MeshSource]]:
    """Return the meshes of each split, by a file or else by fractions.

    Args:
        sources: all meshes.
        split_file: JSON file with the names of the train, val and test meshes.
        fractions: shares of train, val and test.
        seed: which meshes go where, if there is no file.

    Raises:
        InputError: if the file or the fractions cannot be used.
    """
    by_name = {source.name: source for source in sources}
    if split_file is None:
        names = split_by_fractions(list(by_name), fractions, seed)
    else:
        names = split_by_file(Path(split_file), list(by_name))
    return {split: [by_name[name] for name in names[split]] for split in SPLITS}


def pose(sources: Sequence[MeshSource], poses: int) -> list[MeshSource]:
    """Return the meshes with ``poses`` poses in place of each rigged file; 0 leaves all as they are."""
    posed: list[MeshSource] = []
    for source in sources:
        posed += find_poses([source], poses) if isinstance(source, MeshFile) else [source]
    return posed


def join_variants(sources: Sequence[MeshSource], variation: Variation, variants: int) -> list[MeshSource]:
    """Return each mesh followed by ``variants`` individuals of it that ``variation`` makes."""
    return [
        one
        for source in sources
        for one in (source, *(Varied(source, variation, number) for number in range(variants)))
    ]
