"""Specification: hash a benchmark's test data, so that comparable reports can be recognised."""

from pathlib import Path
from typing import Any

from normalgan.benchmark.measure import HintTests
from normalgan.benchmark.settings import digest
from normalgan.data.datamodule import MeshDataModule
from normalgan.errors import InputError
from normalgan.files.json_files import read_json

Specification = dict[str, str | int]

_RULE = "uniform on the object, in the order of a permutation by numpy's default_rng, seeded by the name"
_SCORING = (
    "v3: direction error on the true object wherever a direction is given, at any length; an object is where "
    "vectors are longer than 1/2, or where a submission is opaque; ranked by IoU * error + (1 - IoU) * 90"
)
_DRAWN_ALIKE = ("size", "renderer")  # the size has its own entry, and all renderers give the same maps


def specify(data: MeshDataModule, tests: HintTests, trained: MeshDataModule | None = None) -> Specification:
    """Return hashes of everything that a model's figures depend on.

    ``meshes`` covers the names of the meshes in each split; ``views``, the views and drawing style of the
    test meshes; ``hints``, the positions of the common hints; ``scoring``, the rules for computing figures.
    ``size`` is the side of the pictures in pixels. ``training`` covers the drawing style of the training
    split, if it differs.

    Args:
        data: data of the benchmark.
        tests: hints of the test.
        trained: data of the training split, if they differ.
    """
    recipe = _drawn(data)
    other = {} if trained is None or _drawn(trained) == recipe else {"training": digest(_drawn(trained))}
    return {
        "size": data.recipe.size,
        "meshes": digest({split: [s.name for s in found] for split, found in data.sources.items()}),
        "views": digest({"recipe": recipe, "number": data.views_per_mesh["test"]}),
        "hints": digest({"rule": _RULE, "seed": tests.seed}),
        "scoring": digest({"rule": _SCORING}),
        **other,
    }


def _drawn(data: MeshDataModule) -> dict[str, Any]:
    return {k: v for k, v in data.recipe.describe().items() if k not in _DRAWN_ALIKE}


def check_specification(found: Specification, path: Path) -> str:
    """Check a benchmark against a frozen specification, and return the name of the track.

    Args:
        found: specification of the benchmark's data.
        path: JSON file with the frozen specification for each track and size of pictures.

    Raises:
        InputError: if the specifications differ, or the file is not a specification.
    """
    frozen = _read(path)
    sizes = sorted({int(one["size"]) for one in frozen["sizes"]})
    if found["size"] not in sizes:
        raise InputError(
            f"{path} has no benchmark at {found['size']} pixels; use data.size "
            f"{' or '.join(map(str, sizes))}."
        )
    tracks = {str(one.get("track", "")): one for one in frozen["sizes"] if one["size"] == found["size"]}
    named = {
        track: sorted(name for name in {*found, *wanted} - {"track"} if found.get(name) != wanted.get(name))
        for track, wanted in tracks.items()
    }
    nearest = min(named, key=lambda track: len(named[track]))
    if named[nearest]:
        of_track = f", the track {nearest}" if nearest else ""
        raise InputError(
            f"the test data do not match {frozen['version']}{of_track} in {path}: "
            f"{' and '.join(named[nearest])} differ."
        )
    return nearest


def _read(path: Path) -> dict[str, Any]:
    right = 'it must be like {"version": "v3", "sizes": [{"size": 128, "meshes": "…", "views": "…"}]}.'
    content: dict[str, Any] = read_json(path, "the specification", right)
    sizes = content.get("sizes") if isinstance(content, dict) else None
    good = (
        isinstance(sizes, list)
        and bool(sizes)
        and all(isinstance(one, dict) and isinstance(one.get("size"), int) for one in sizes)
    )
    if not good or not isinstance(content.get("version"), str):
        raise InputError(f"the specification {path} has no version or sizes; {right}")
    return content
