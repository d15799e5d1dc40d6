"""Times the integration of normal maps to heights, and measures its error on known shapes.

heights.py [ROUNDS]: how often each size is timed. Prints JSON.
"""

import json
import statistics
import sys
import time

import numpy as np
from machine import describe
from numpy.typing import NDArray

from normalgan.arrays import Floats
from normalgan.inference.heights.height import integrate
from normalgan.normals import normalize

SIDES = (256, 512, 1024)


def body(side: int) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Return the normals, the mask and the heights in pixels of half an ellipsoid with a ball in front."""
    along = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(along, -along)
    normals, mask = np.zeros((side, side, 3)), np.zeros((side, side), np.bool_)
    heights = np.zeros((side, side))
    for centre, half, before in (((0.0, 0.1), (0.9, 0.6, 0.5), 0.0), ((0.3, -0.3), (0.25, 0.6, 0.25), 0.4)):
        across, up = x - centre[0], y - centre[1]
        rest = 1 - (across / half[0]) ** 2 - (up / half[1]) ** 2
        z = half[2] * np.sqrt(np.maximum(rest, 0))
        there = rest > 0
        normals[there] = np.stack([across / half[0] ** 2, up / half[1] ** 2, z / half[2] ** 2], -1)[there]
        heights[there] = (z + before)[there] * side / 2
        mask |= there
    return normalize(normals), mask, heights.astype(np.float32)


def main(rounds: int = 3) -> None:
    """Print the figures."""
    small = body(32)
    integrate(small[0], small[1])  # imports its solver
    figures: dict[str, object] = {}
    for side in SIDES:
        normals, mask, true = body(side)
        wall, busy = [], []
        for _ in range(rounds):
            start, worked = time.perf_counter(), time.process_time()
            found = integrate(normals, mask)
            wall.append(time.perf_counter() - start)
            busy.append(time.process_time() - worked)
        figures[str(side)] = {
            "wall_s": round(statistics.median(wall), 3),
            "processor_s": round(statistics.median(busy), 3),
            "on_the_object": round(float(mask.mean()), 3),
            "correlation_with_true_heights": round(float(np.corrcoef(found[mask], true[mask])[0, 1]), 4),
        }
    figures["machine"] = describe("numpy", "scipy")
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
