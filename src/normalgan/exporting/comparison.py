"""Compare an exported model with torch, including in half precision."""

import numpy as np
import torch

from normalgan.arrays import Floats
from normalgan.exporting.deployed import Deployed
from normalgan.exporting.formats import Run
from normalgan.normals import angles
from normalgan.rendering.strokes import Stroke, rasterise

_STROKES, _HINTS = 12, 15
_OBJECT = 0.5
"""Normals shorter than this in torch's output count as background."""


def examples(count: int, size: int, seed: int = 0) -> tuple[Floats, Floats]:
    """Return random scribbles (N, 1, S, S) and random hints (N, 4, S, S), determined by the seed."""
    rng = np.random.default_rng(seed)
    sketches = np.zeros((count, 1, size, size), np.float32)
    hints = np.zeros((count, 4, size, size), np.float32)
    for sketch, hint in zip(sketches, hints, strict=True):
        strokes = []
        for _ in range(_STROKES):
            walk = np.cumsum(rng.normal(0, size / 24, (12, 2)), axis=0) + rng.uniform(0, size, 2)
            strokes.append(Stroke.even(walk, rng.uniform(0.8, 2.0)))
        sketch[0] = rasterise(strokes, size)
        normals = rng.normal(size=(_HINTS, 3))
        normals[:, 2] = np.abs(normals[:, 2])
        rows, columns = rng.integers(0, size, (2, _HINTS))
        hint[:3, rows, columns] = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).T
        hint[3, rows, columns] = 1
    return sketches, hints


def predict(model: Deployed, sketch: Floats, hints: Floats) -> list[Floats]:
    """Return torch's prediction for sketches and hints."""
    with torch.no_grad():
        return [output.numpy() for output in model(torch.from_numpy(sketch), torch.from_numpy(hints))]


def largest_difference(model: Deployed, run: Run) -> float:
    """Return the largest difference between an exported model and torch, with and without hints.

    Batches of one and of three pictures are tried, so a model with a fixed batch size fails here. The
    confidence has no upper bound, so its difference is relative for values above 1.
    """
    worst = 0.0
    for count, hinted in ((1, True), (3, True), (2, False)):
        sketch, hints = examples(count, model.size, seed=count)
        hints = hints if hinted else np.zeros_like(hints)
        for wanted, found in zip(predict(model, sketch, hints), run(sketch, hints), strict=True):
            if found.shape != wanted.shape or found.dtype != np.float32 or not np.isfinite(found).all():
                return float("inf")
            worst = max(worst, float((np.abs(found - wanted) / np.maximum(np.abs(wanted), 1)).max()))
    return worst


def turn_in_degrees(model: Deployed, run: Run) -> tuple[float, float]:
    """Return the mean and largest angle in degrees between an exported model's normals and torch's.

    If torch predicts no object in the scribbles, every pixel counts.
    """
    sketch, hints = examples(4, model.size)
    wanted = predict(model, sketch, hints)[0].astype(np.float64)
    found = run(sketch, hints)[0].astype(np.float64)
    angle = angles(np.moveaxis(wanted, 1, -1), np.moveaxis(found, 1, -1))
    there = np.linalg.norm(wanted, axis=1) > _OBJECT
    angle = angle[there] if there.any() else angle
    return float(angle.mean()), float(angle.max())
