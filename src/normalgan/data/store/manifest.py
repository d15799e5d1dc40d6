"""Manifest: what a stored data set holds, and the key that names its folder."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from normalgan.data.recipe import Loadable, SampleRecipe, fingerprint
from normalgan.data.splits import none_usable, plural, repeated
from normalgan.data.store.fsspec_storage import ObjectFolder
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError
from normalgan.files.json_files import encode_json

FORMAT_VERSION = 1
"""Version of the storage format. Increase it if the format changes, so that samples are created again."""

_NAME = "dataset.json"
_SUM = "sha256"
_KEYS = {"format", "samples", "recipe", "splits", _SUM}


@dataclass(frozen=True)
class Manifest:
    """The description of a data set, stored as human-readable ``dataset.json``.

    The file includes a SHA-256 hash of its own content to detect corruption.

    Args:
        recipe: recipe of the samples, from `Recipe.describe`.
        splits: layout of each split by name.
    """

    recipe: dict[str, Any]
    splits: dict[str, Layout]

    def stores(self, folder: ObjectFolder) -> dict[str, ShardedSamples]:
        """Return the stores of the samples by split, for writing."""
        return {split: ShardedSamples(folder.url, split, layout) for split, layout in self.splits.items()}

    def finished(self, folder: ObjectFolder, noun: str) -> tuple[dict[str, ShardedSamples], dict[str, str]]:
        """Return the stores by split, for reading, and the reasons for failed meshes by name.

        Raises:
            InputError: if no mesh of a split could be rendered.
        """
        stores, reasons = {}, {}
        for split, store in self.stores(folder).items():
            failed = {mesh: why for part in store.failures().values() for mesh, why in part.items()}
            if set(failed) >= set(store.layout.meshes):
                first = store.layout.meshes[0]
                raise none_usable(len(failed), noun, split, f"{first}: {failed[first]}")
            stores[split] = ShardedSamples(folder.url, split, store.layout, failed)
            reasons.update(failed)
        return stores, reasons

    def write(self, folder: ObjectFolder) -> None:
        """Write the arrays' metadata, then the manifest."""
        self.describe(folder)
        counts = {split: len(layout) for split, layout in self.splits.items()}
        content = {"format": FORMAT_VERSION, "samples": counts, **asdict(self)}
        folder.write(_NAME, encode_json(content | {_SUM: _digest(content)}))

    def describe(self, folder: ObjectFolder) -> None:
        """Write the arrays' metadata where it is missing or damaged."""
        for store in self.stores(folder).values():
            store.create()

    @staticmethod
    def damaged(folder: ObjectFolder) -> bool:
        """Return whether there is a manifest that `read` rejects."""
        return folder.size(_NAME) is not None and Manifest.read(folder) is None

    @staticmethod
    def read(folder: ObjectFolder) -> "Manifest | None":
        """Return the manifest in a folder, or None if it is missing or damaged."""
        try:
            content = json.loads(folder.read(_NAME) or b"")
            if set(content) - _KEYS or content.pop(_SUM) != _digest(content):
                return None
            splits = {
                split: Layout(**{**layout, "meshes": tuple(layout["meshes"])})
                for split, layout in content["splits"].items()
            }
            return Manifest(dict(content["recipe"]), splits)
        except (ValueError, TypeError, KeyError, AttributeError):
            return None


def _digest(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def fingerprints(sources: Mapping[str, Sequence[Loadable]]) -> dict[str, list[tuple[str, str]]]:
    """Return name and fingerprint of each mesh by split, including unreadable meshes."""
    return {split: [(source.name, fingerprint(source)) for source in part] for split, part in sources.items()}


def dataset_key(
    meshes: Mapping[str, Sequence[tuple[str, str]]], views: Mapping[str, int], recipe: SampleRecipe
) -> str:
    """Return the folder name of a data set: 24 hexadecimal digits.

    It depends on everything that affects the stored bytes: names, fingerprints and order of the meshes,
    views per mesh, recipe, and the versions of rendering and format.
    """
    everything = [FORMAT_VERSION, recipe.describe(), [[s, views[s], meshes[s]] for s in meshes]]
    return hashlib.sha256(json.dumps(everything, sort_keys=True).encode()).hexdigest()[:24]


def views_by_split(
    views_per_mesh: int | Mapping[str, int], sources: Mapping[str, Sequence[Loadable]], noun: str = "mesh"
) -> dict[str, int]:
    """Return the number of views per mesh for each split with meshes.

    Raises:
        InputError: if a number is not positive, or two meshes have the same name.
    """
    names = [source.name for part in sources.values() for source in part]
    if twins := repeated(names):
        raise InputError(
            f"two {plural(noun)} are named {min(twins)}; each {noun} needs a unique name, in one split."
        )
    if not names:
        raise InputError(f"there are no {plural(noun)} to make samples of; give at least one.")
    views = {}
    for split, part in sources.items():
        if part:
            number = views_per_mesh if isinstance(views_per_mesh, int) else views_per_mesh.get(split, 0)
            if number < 1:
                raise InputError(
                    f"{number} views per {noun} are requested for {split}; it must be at least 1."
                )
            views[split] = number
    return views
