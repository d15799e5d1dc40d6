"""Tells how well the object is found that the lines of a drawing enclose: on animals, drawn with gaps.

outline.py [ANIMALS]: how many of the embedded animals are drawn, three views each. Prints JSON.
"""

import json
import sys
import time

import numpy as np
from machine import describe

from normalgan.animals import SPECIES, Animal
from normalgan.inference.mask.outline_mask import fill_outline
from normalgan.rendering import EmbreeRenderer, Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.samples import Recipe

SIDE, VIEWS = 256, 3
HANDS = {
    "usual": Hand(strength=(0.6, 1.0)),
    "leaves_out_much": Hand(strength=(0.8, 1.0), gaps=0.02, missed_parts=0.35, cuts=2.5),
}


def main(animals: int = 18) -> None:
    """Print the figures."""
    names = list(SPECIES)[:: max(len(SPECIES) // animals, 1)][:animals]
    meshes = [Animal(name, number % 3).load() for number, name in enumerate(names)]
    figures: dict[str, object] = {"animals": names}
    for title, hand in HANDS.items():
        recipe = Recipe(Views(), EmbreeRenderer(), SuggestiveContours(resolution=SIDE), SIDE, 7, hand)
        overlaps, times = [], []
        for mesh in meshes:
            for index in range(VIEWS):
                sample = recipe.render(mesh, index)
                ink = sample.sketch.astype(np.float32) / np.float32(255)
                start = time.process_time()
                mask = fill_outline(ink).mask
                times.append(time.process_time() - start)
                overlaps.append((mask & sample.mask).sum() / (mask | sample.mask).sum())
        figures[title] = {
            "sketches": len(overlaps),
            "mean_iou": round(float(np.mean(overlaps)), 4),
            "median_iou": round(float(np.median(overlaps)), 4),
            "tenth_percentile_iou": round(float(np.percentile(overlaps, 10)), 4),
            "below_half": int(np.sum(np.array(overlaps) < 0.5)),
            "processor_ms": round(1000 * float(np.median(times)), 2),
        }
    print(json.dumps({**figures, "machine": describe("numpy", "opencv-python-headless")}, indent=1))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
