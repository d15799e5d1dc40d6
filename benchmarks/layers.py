"""Measures which context suits a layer best, by the mean angular error of parts and of whole objects.

layers.py MESH…

Each mesh is drawn at 512 pixels. A *part*, 8 to 40 % of it, is cut off at the top or at one side and becomes
the layer in front of the rest. As a *whole* object, the mesh stands in front of another one at 15 to 60 % of
its size. The layer in front is predicted alone, among the others, and as `generate --layers` and the studio
choose.
"""

import argparse
import itertools
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from normalgan.__main__ import main as normalgan
from normalgan.arrays import BoolMask, Floats
from normalgan.errors import InputError
from normalgan.inference.composites.layer_context import Inferred, context_of, surest, ways_to_see
from normalgan.inference.conversion import read_map
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.pipeline import finish
from normalgan.inference.preparation import Prepared, prepare
from normalgan.inference.reading.picture import Picture, read_picture
from normalgan.normals import normalize
from normalgan.weights.shipped import SHIPPED

SIDE, OVERLAP = 512, 6
PARTS, WHOLES = (0.08, 0.15, 0.25, 0.4), (0.15, 0.25, 0.4, 0.6)
LEAST_PIXELS = 300
"""The smallest part that is measured, in pixels."""
Layer = tuple[Floats, BoolMask]
"""Lines (H, W), and the object's pixels (H, W)."""


@dataclass(frozen=True)
class View:
    """The lines (H, W), object (H, W) and true normals (H, W, 3) of a mesh."""

    ink: Floats
    mask: BoolMask
    normals: Floats


def view(mesh: Path, folder: Path, azimuth: int) -> View:
    """Draw a mesh."""
    lines, truth = folder / "lines.png", folder / "normals.png"
    given = f"-o {lines} --normal {truth} --azimuth {azimuth} --size {SIDE}".split()
    if normalgan(["sketch", str(mesh), *given]):
        raise InputError(f"{mesh} cannot be drawn")
    ink, drawn = 1 - read_picture(lines).colour[..., 0], read_map(truth)
    return View(ink, drawn.mask, drawn.extended)


def parts_of(seen: View) -> Iterator[list[Layer]]:
    """Yield pairs of layers: the rest of an object, and in front of it the part that was cut off."""
    rows, columns = np.mgrid[: seen.ink.shape[0], : seen.ink.shape[1]]
    for share, along in itertools.product(PARTS, (rows, columns)):
        reach = along[seen.mask]
        at = reach.min() + share * np.ptp(reach)
        part, rest = seen.mask & (along < at), seen.mask & (along >= at - OVERLAP)
        if np.count_nonzero(part) >= LEAST_PIXELS:
            yield [_cut(seen.ink, rest, along - at + OVERLAP), _cut(seen.ink, part, along - at)]


def _cut(ink: Floats, mask: BoolMask, away: Floats) -> Layer:
    """Return the lines of a part, with an additional line along the cut."""
    rim = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0
    near = cv2.dilate(mask.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    return np.maximum(np.where(near, ink, 0), rim & (np.abs(away) < 3)).astype(np.float32), mask


def before(seen: View, other: View, share: float) -> tuple[list[Layer], View]:
    """Return another object with this one in front at a share of its size, and the view of it there."""
    side, canvas = round(2 * SIDE * share), (2 * SIDE, 2 * SIDE)
    top, left = min(SIDE, 2 * SIDE - side), min(SIDE - SIDE // 8, 2 * SIDE - side)
    place = np.s_[top : top + side, left : left + side]
    ink, mask = np.zeros(canvas, np.float32), np.zeros(canvas, bool)
    normals = np.zeros((*canvas, 3), np.float32)
    ink[place] = np.minimum(1.5 * cv2.resize(seen.ink, (side, side), interpolation=cv2.INTER_AREA), 1)
    normals[place] = normalize(np.asarray(cv2.resize(seen.normals, (side, side)), np.float32))
    mask[place] = cv2.resize(seen.mask.astype(np.uint8), (side, side)) > 0
    back = (
        np.asarray(cv2.resize(other.ink, canvas), np.float32),
        cv2.resize(other.mask.astype(np.uint8), canvas) > 0,
    )
    return [back, (ink, mask)], View(ink, mask, normals)


def errors(backend: OnnxBackend, layers: list[Layer], normals: Floats) -> list[float]:
    """Return the mean angular errors in degrees of the layer in front: alone, among the others, as chosen."""
    prepared = [
        prepare(Picture(np.dstack([1 - ink] * 3), None), backend.size, mask, line_widths=backend.line_widths)
        for ink, mask in layers
    ]

    def infer(way: Prepared) -> Inferred:
        return backend.predict(way.model_input, way.hints)

    ways = ways_to_see(prepared[-1], context_of(prepared))
    maps = [finish(way, *infer(way), backend.upsample) for way in ways]
    maps.append(finish(*surest(ways, infer), backend.upsample))
    inside = layers[-1][1]
    cosines = [(each.extended * normals).sum(-1)[inside] for each in maps]
    return [float(np.degrees(np.arccos(np.clip(each, -1, 1))).mean()) for each in cosines]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", nargs="+", type=Path)
    meshes = parser.parse_args().meshes
    backend = OnnxBackend(SHIPPED)
    with tempfile.TemporaryDirectory() as folder:
        views = [view(mesh, Path(folder), 35 if k % 2 else 80) for k, mesh in enumerate(meshes)]
    found: dict[str, list[list[float]]] = {"parts": [], "whole objects": []}
    for k, seen in enumerate(views):
        found["parts"] += [errors(backend, layers, seen.normals) for layers in parts_of(seen)]
        for share in WHOLES:
            layers, placed = before(seen, views[(k + 3) % len(views)], share)
            found["whole objects"].append(errors(backend, layers, placed.normals))
    print("layer in front   count   alone   among   chosen")
    for kind, rows in found.items():
        print(f"{kind:16} {len(rows):5}  ", "   ".join(f"{each:5.2f}°" for each in np.mean(rows, 0)))


if __name__ == "__main__":
    main()
