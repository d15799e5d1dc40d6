"""Prints how many hints CurvatureHints gives for views of meshes: fewest, median, most, in total and by mesh.

tools/hint_counts.py 'meshes/*.off' [SIZE [VIEWS [ORIENTATION]]]
`animals` in place of meshes takes 20 embedded animals.
"""

import argparse
from statistics import median

import torch

from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import EmbeddedAnimals, MeshReading, Split
from normalgan.hints import CurvatureHints
from normalgan.hints.draw import draw_hints_by_name
from normalgan.rendering.cameras import Views
from normalgan.rendering.renderers.embree import EmbreeRenderer
from normalgan.rendering.samples import sample_rng


def main(meshes: str, size: int, views: int, orientation: str | None) -> None:
    """Render the maps of this many views of each mesh with seed 0, and count the hints."""
    given = None if meshes == "animals" else meshes
    animals, reading = EmbeddedAnimals(20), MeshReading(orientation=orientation)
    data = MeshDataModule(given, animals=animals, reading=reading, split=Split((1.0, 0.0, 0.0)), size=size)
    every: list[int] = []
    for source in data.sources["train"]:
        mesh, counts = source.load(), []
        for index in range(views):
            camera = Views().camera(mesh, sample_rng(0, mesh.name, index, "views"))
            maps = EmbreeRenderer().render(mesh, camera, size)
            normal = torch.from_numpy(maps.normal).permute(2, 0, 1)[None].float()
            mask = torch.from_numpy(maps.mask)[None, None].float()
            hints = draw_hints_by_name(CurvatureHints(), normal, mask, [f"{mesh.name}/{index}"], 0)
            counts.append(int(hints[:, 3].sum()))
        print(f"{mesh.name}: {min(counts)}, {median(counts):g}, {max(counts)}", flush=True)
        every += counts
    print(f"all {len(every)} views: {min(every)}, {median(every):g}, {max(every)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes")
    parser.add_argument("size", nargs="?", type=int, default=256)
    parser.add_argument("views", nargs="?", type=int, default=10)
    parser.add_argument("orientation", nargs="?")
    main(**vars(parser.parse_args()))
