"""Renders meshes into a cache of views for the reader's training, each with strokes, mask and colours.

views.py OUT MESHES… [--size 384] [--part 0/1]

MESHES are folders, each with an optional number of views per mesh, as in data/objects:2. Existing views are
kept.
"""

import argparse
import hashlib
import json
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.animals import make_animals
from normalgan.errors import InputError
from normalgan.rendering import find_meshes
from normalgan.rendering.cameras import Views
from normalgan.rendering.lines.contours import OccludingContours
from normalgan.rendering.lines.suggestive import SuggestiveContours
from normalgan.rendering.mesh import MeshSource
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.rigs import find_poses
from normalgan.rendering.view import View

POINT = 32
"""Points are stored as integers in units of 1/POINT pixel."""
CHUNK = 100
CREASED = ("objects", "things", "procedural_props")
_GROUND = ("Tile", "Hexagon", "hex_", "terrain")


def sources(folder: str, views: int) -> Iterator[tuple[str, MeshSource, int]]:
    """Yield the name of each view, its mesh's source and its number."""
    kind = Path(folder).name
    if kind == "herd":
        groups = [
            "quadrupeds",
            "bipeds",
            "plush",
            "blobs",
            "birds",
            "fish",
            "insects",
            "reptiles",
            "mug",
            "vase",
            "teapot",
        ]
        meshes: list[MeshSource] = [*make_animals(240, 7, groups)]
    else:
        files = find_meshes(folder, None, 35.0 if kind in CREASED else None)
        meshes = [*files]
        if kind in ("animals", "rigs"):
            meshes = [*find_poses(files, 12 if kind == "animals" else 3)]
    for mesh in meshes:
        for number in range(views):
            yield f"{kind}/{mesh.name}/{number}", mesh, number


def rendered(name: str, source: MeshSource, number: int, size: int) -> dict[str, NDArray[Any]] | None:
    """Return the stored data of a view; None if it shows nothing, or only a sliver."""
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big"))
    mesh = source.load()
    camera = Views(elevation=(-10, 45), roll=(-6, 6)).camera(mesh, rng)
    view = View(mesh, camera, EmbreeRenderer(), size)
    maps = view.maps()
    if maps.mask.mean() < 0.02:
        return None
    outline = OccludingContours(crease=None).trace(view, rng)
    style = rng.integers(3)
    inner = []
    if style == 0 or name.split("/", maxsplit=1)[0] in CREASED:
        creased = OccludingContours(crease=float(rng.uniform(30, 60))).trace(view, rng)
        inner = creased[len(outline) :]
    if style == 1 and name.split("/", maxsplit=1)[0] not in CREASED:
        inner = SuggestiveContours().trace(view, rng)[len(outline) :]
    strokes = [*outline, *inner]
    if not strokes or len(strokes) > 400:
        return None
    lengths, points = [], []
    for stroke in strokes:
        path = np.asarray(stroke.points)[::2]
        if not np.array_equal(path[-1], stroke.points[-1]):
            path = np.concatenate([path, stroke.points[-1:]])
        points.append(np.rint(np.clip(path, -100, size + 100) * POINT).astype(np.int16))
        lengths.append(len(path))
    normal = cv2.resize(maps.normal, (96, 96), interpolation=cv2.INTER_AREA)
    return {
        "mask": np.packbits(maps.mask),
        "normal": np.rint(127 * normal).astype(np.int8),
        "points": np.concatenate(points),
        "lengths": np.array(lengths, np.int32),
        "outlines": np.array(len(outline), np.int32),
    }


def main() -> None:
    """Render the views that do not exist yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--size", type=int, default=384)
    parser.add_argument("--part", default="0/1")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    cv2.setNumThreads(1)
    part, parts = map(int, given.part.split("/"))
    given.out.mkdir(parents=True, exist_ok=True)
    wanted: list[tuple[str, MeshSource, int]] = []
    for folder in given.meshes:
        path, _, views = folder.partition(":")
        wanted += sources(path, int(views or 1))
    order = np.random.default_rng(0).permutation(len(wanted))
    wanted = [wanted[k] for k in order if not any(word in wanted[k][0] for word in _GROUND)]
    print(len(wanted), "views", flush=True)
    for start in range(part * CHUNK, len(wanted), parts * CHUNK):
        target = given.out / f"views_{start:05d}.npz"
        if target.exists():
            continue
        arrays: dict[str, NDArray[Any]] = {}
        names: list[str] = []
        for name, source, number in wanted[start : start + CHUNK]:
            try:
                view = rendered(name, source, number, given.size)
            except (InputError, ValueError) as error:
                print(name, error, file=sys.stderr)
                continue
            if view is not None:
                arrays |= {f"{len(names)}.{key}": value for key, value in view.items()}
                names.append(name)
        temporary = target.with_name("." + target.name)
        np.savez_compressed(temporary, allow_pickle=False, names=json.dumps(names), **arrays)
        temporary.replace(target)
        print(target.name, len(names), flush=True)


if __name__ == "__main__":
    main()
