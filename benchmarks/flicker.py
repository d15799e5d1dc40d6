"""Measures how much the maps of an animation flicker: rigs posed before one camera, drawn and predicted.

flicker.py RIG.glb [RIG.glb...] [--clips Idle Walk Gallop] [--frames 12] [--model M.onnx] [--sheet OUT.png]

Prints JSON. For each clip and each way of predicting, it gives the error, the flicker and the overlap of the
masks. The flicker is how much predicted and true normals change from frame to frame where the true ones
change by less than a degree. The ways: each drawing cropped by itself, all drawings cropped alike, and the
latter averaged with neighbouring frames.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from machine import describe
from numpy.typing import NDArray
from PIL import Image

from normalgan.arrays import Floats
from normalgan.inference.composites.series import Member, predict_series
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.preview import lit
from normalgan.inference.predictor import Predictor
from normalgan.inference.reading.picture import Picture
from normalgan.normals import angles, encode, paint_flat
from normalgan.rendering import EmbreeRenderer, find_meshes
from normalgan.rendering.cameras import framed, look_at_origin
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh_files import MeshFile
from normalgan.rendering.rigs import ClipMeshes
from normalgan.rendering.strokes import rasterise
from normalgan.rendering.view import View
from normalgan.weights.shipped import find_model

SIDE, AZIMUTH, ELEVATION, STILL = 256, 60.0, 10.0, 1.0
WIDEST_SHEET = 1080
"""The largest width of the picture in pixels."""
MARGIN = 6
"""Margin in pixels above and below the visible part of the frames."""
WAYS = {"own": (False, False), "shared": (True, False), "steady": (True, True)}


def draw(file: MeshFile, clip: str, count: int) -> tuple[list[Floats], list[Maps]]:
    """Return the drawings of a clip, (SIDE, SIDE) ink each, and their true maps."""
    meshes = ClipMeshes(file, clip)
    camera = framed(meshes.hull, look_at_origin(AZIMUTH, ELEVATION, 0.0), None, 0.06)
    lines, inks, truths = SuggestiveContours(resolution=SIDE), [], []
    for moment in np.linspace(*meshes.span, count, endpoint=False):
        view = View(meshes.mesh(float(moment)), camera, EmbreeRenderer(), SIDE)
        inks.append(rasterise(lines.trace(view, np.random.default_rng(0)), SIDE))
        truths.append(view.maps())
    return inks, truths


def measure(maps: list[NormalMap], truths: list[Maps]) -> dict[str, float]:
    """Return the figures of one clip predicted in one way."""
    errors, overlaps, flicker, moved = [], [], [], []
    for preds, true in zip(maps, truths, strict=True):
        both = preds.mask & true.mask
        errors.append(angles(preds.extended[both], true.normal[both]).mean())
        overlaps.append(both.sum() / (preds.mask | true.mask).sum())
    for i in range(1, len(maps)):
        change = angles(truths[i].normal, truths[i - 1].normal)
        still = truths[i].mask & truths[i - 1].mask & maps[i].mask & maps[i - 1].mask & (change < STILL)
        if still.any():
            moved.append(change[still].mean())
            flicker.append(angles(maps[i].extended[still], maps[i - 1].extended[still]).mean())
    return {
        "error": round(float(np.mean(errors)), 2),
        "flicker": round(float(np.mean(flicker)), 3) if flicker else float("nan"),
        "true_change": round(float(np.mean(moved)), 3) if moved else float("nan"),
        "mask_iou": round(float(np.mean(overlaps)), 3),
    }


def strip(maps: list[NormalMap]) -> NDArray[np.uint8]:
    """Return maps side by side with the lit maps below, cut to the rows that hold something."""
    rows = np.flatnonzero(np.any([each.mask.any(1) for each in maps], axis=0))
    shown = slice(max(rows[0] - MARGIN, 0), rows[-1] + MARGIN)
    colours = [np.asarray(encode(paint_flat(each.extended, each.mask)), np.uint8) for each in maps]
    lamps = [lit(each.extended, each.mask, 135) for each in maps]
    return np.vstack([np.hstack(each)[shown] for each in (colours, lamps)])


def main() -> None:
    """Print the figures, and write a picture on request."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rigs", nargs="+")
    parser.add_argument("--clips", nargs="+", default=["Idle", "Walk", "Gallop"])
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--model")
    parser.add_argument("--sheet", type=Path, help="picture of the first rig's maps, a row for each way")
    asked = parser.parse_args()
    predictor = Predictor(OnnxBackend(find_model(asked.model)))
    figures: dict[str, dict[str, dict[str, float]]] = {}
    strips = []
    for file in find_meshes(asked.rigs):
        for clip in asked.clips:
            inks, truths = draw(file, clip, asked.frames)
            members = [Member(Picture(np.repeat(1 - ink[..., None], 3, -1), None)) for ink in inks]
            found = {}
            for way, (shared, steady) in WAYS.items():
                maps = list(predict_series(predictor, members, shared, steady))
                good = [each for each in maps if isinstance(each, NormalMap)]
                found[way] = measure(good, truths)
                if file.name == Path(asked.rigs[0]).stem and way != "shared":
                    strips.append(strip(good[: min(6, len(good))]))
            figures[f"{file.name} {clip}"] = found
    if asked.sheet:
        sheet = Image.fromarray(np.vstack(strips))
        size = min(sheet.width, WIDEST_SHEET), round(sheet.height * min(WIDEST_SHEET / sheet.width, 1))
        sheet.resize(size, Image.Resampling.LANCZOS).save(asked.sheet, optimize=True)
    print(json.dumps({"clips": figures, "machine": describe("numpy", "onnxruntime")}, indent=1))


if __name__ == "__main__":
    main()
