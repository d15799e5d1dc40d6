"""Measures `normalgan generate` at full size against the truth: meshes drawn large, without hints.

full_size.py MESHES… [--size 1024] [--views 2] [--line-width 3] [--crease-angle 40] [--model FILE]
    [--picture FILE]

Prints JSON: the mean angular error on the object, at its rim and deep inside; the error of the predicted n_z;
and how well the object is found. The rim is everything within 1/170 of the picture's side of the silhouette.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from machine import ONE_THREAD, describe

from normalgan.inference.conversion import read_map
from normalgan.inference.normal_map import NormalMap
from normalgan.normals import angles, encode
from normalgan.rendering import EmbreeRenderer, Views, find_meshes
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.samples import Recipe, Sample

RIM, DEEP = 1 / 170, 1 / 20
"""Distances from the silhouette, as shares of the side, where the rim ends and the deep inside begins."""


def main(arguments: list[str]) -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--views", type=int, default=2)
    parser.add_argument("--line-width", type=float, default=3.0)
    parser.add_argument("--crease-angle", type=float)
    parser.add_argument("--orientation")
    parser.add_argument("--model")
    parser.add_argument("--picture", type=Path)
    given = parser.parse_args(arguments)
    lines = SuggestiveContours(line_width=given.line_width, interior_width=0.7 * given.line_width)
    recipe = Recipe(Views(), EmbreeRenderer(), lines, given.size, seed=11)
    sources = find_meshes(given.meshes, given.orientation, given.crease_angle)
    samples = {
        f"{source.name}_{view}": recipe.render(mesh, view)
        for source in sources
        for mesh in [source.load()]
        for view in range(given.views)
    }
    with tempfile.TemporaryDirectory() as folder:
        predicted = _predict(samples, Path(folder), given.model)
    rows = {name: _measure(samples[name], predicted[name]) for name in samples}
    if given.picture:
        _draw(samples, predicted, given.picture)
    means = {
        key: round(float(np.mean([row[key] for row in rows.values()])), 4)
        for key in next(iter(rows.values()))
    }
    report = {"drawings": len(rows), **means, "each": rows}
    print(json.dumps({**report, "machine": describe("numpy", "onnxruntime")}, indent=1))


def _predict(samples: dict[str, Sample], folder: Path, model: str | None) -> dict[str, NormalMap]:
    """Return the map that the command predicts for each sketch."""
    (folder / "in").mkdir()
    for name, sample in samples.items():
        cv2.imwrite(str(folder / "in" / f"{name}.png"), 255 - sample.sketch)
    command = f"-m normalgan generate {folder}/in -o {folder}/out --bits 16 --alpha".split()
    more = ["--model", model] if model else []
    subprocess.run(
        [sys.executable, *command, *more], check=True, stdout=sys.stderr, env={**os.environ, **ONE_THREAD}
    )
    return {name: read_map(folder / "out" / f"{name}_normal.png") for name in samples}


def _measure(sample: Sample, preds: NormalMap) -> dict[str, float]:
    """Return the figures of one drawing; angles are means over the part of the true object that was found."""
    mask, normals, found = sample.mask, preds.extended, preds.mask
    truth = sample.normal.astype(np.float32)
    angle = angles(normals, truth)
    depth = cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 5) / mask.shape[0]
    both = mask & found
    inside = {"rim": both & (depth <= RIM), "deep": both & (depth > DEEP)}
    return {
        "degrees": float(angle[both].mean()),
        **{f"degrees_{name}": float(angle[where].mean()) for name, where in inside.items() if where.any()},
        "n_z_true": float(truth[..., 2][both].mean()),
        "n_z_off": float((normals[..., 2] - truth[..., 2])[both].mean()),
        "mask_iou": float(both.sum() / (mask | found).sum()),
    }


def _draw(samples: dict[str, Sample], predicted: dict[str, NormalMap], path: Path) -> None:
    """Write rows of sketch, predicted map, true map, and both maps lit from the upper left."""
    light = np.array([-0.5, 0.6, 0.62], np.float32)
    rows = []
    for name, sample in samples.items():
        ink = np.repeat(255 - sample.sketch[..., None], 3, axis=-1)
        columns = [ink]
        preds, truth = predicted[name], sample.normal.astype(np.float32)
        maps = (preds.extended, preds.mask), (truth, sample.mask)
        for normals, mask in maps:
            colours = np.asarray(encode(normals * mask[..., None]), np.uint8)
            lit = np.where(mask, np.clip(normals @ light, 0.05, 1), 1)[..., None] * np.float32(255)
            columns += [colours, np.repeat(lit, 3, axis=-1).astype(np.uint8)]
        rows.append(np.concatenate(columns, axis=1))
    cv2.imwrite(str(path), np.concatenate(rows)[..., ::-1])


if __name__ == "__main__":
    main(sys.argv[1:])
