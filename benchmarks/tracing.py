"""Compares drawings traced in maps of 512 pixels with those traced in 1024: tracing.py [ANIMALS]."""

import dataclasses
import sys

import cv2
import numpy as np
from numpy.typing import NDArray

from normalgan.animals import make_animals
from normalgan.arrays import Floats
from normalgan.rendering import Camera, PyrenderRenderer, Views
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.strokes import Stroke, rasterise
from normalgan.rendering.view import View

SIZE, VIEWS, SHIFT = 256, 3, 5 / 16


def draw(mesh: Mesh, camera: Camera, resolution: int, shift: float = 0.0) -> Floats:
    """Return the sketch traced in maps of some resolution, all strokes moved right and up by pixels."""
    view = View(mesh, camera, PyrenderRenderer(), SIZE)
    strokes = SuggestiveContours(resolution=resolution).trace(view, np.random.default_rng(0))
    by = np.array([shift, -shift])
    return rasterise([Stroke(each.points + by, each.width, each.darkness) for each in strokes], SIZE)


def moved(camera: Camera, pixels: float) -> Camera:
    """Return the camera with its window moved right and up by pixels of the sketch."""
    left, right, bottom, top = camera.window
    by = (right - left) / SIZE * pixels
    return dataclasses.replace(camera, window=(left + by, right + by, bottom + by, top + by))


def found(inked: NDArray[np.bool_], other: NDArray[np.bool_]) -> float:
    """Return the share of inked pixels that have ink of the other drawing within a pixel."""
    away = cv2.distanceTransform((~other).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return float((away[inked] <= 1.001).mean())


def compare(sketch: Floats, reference: Floats) -> tuple[float, float, float]:
    """Return precision and recall of the ink, and the amount of it over the reference's."""
    one, other = sketch > 0.5, reference > 0.5
    return found(one, other), found(other, one), float(sketch.sum() / reference.sum())


def main(animals: int = 20) -> None:
    """Print precision, recall and ink over all views."""
    rows = []
    for number, animal in enumerate(make_animals(animals)):
        mesh = animal.load()
        for index in range(VIEWS):
            camera = Views().camera(mesh, np.random.default_rng([number, index]))
            reference = draw(mesh, camera, 1024)
            coarse = compare(draw(mesh, camera, 512), reference)
            rows.append((*coarse, *compare(draw(mesh, moved(camera, SHIFT), 1024, SHIFT), reference)))
    figures = np.array(rows).reshape(-1, 2, 3)
    for name, part in zip(("traced at 512", "camera moved"), figures.transpose(1, 0, 2), strict=True):
        mean, worst = part.mean(axis=0), part[:, :2].min()
        print(f"{name}: precision {mean[0]:.4f}, recall {mean[1]:.4f}, worst {worst:.3f}, ink {mean[2]:.3f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
