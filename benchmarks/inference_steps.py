"""Times each step from a drawing to its map, in processor time on one thread, so the machine may be busy.

inference_steps.py [MODEL] [--sides 256 512 1024] [--rounds 15] [--pen 0]: the model that comes with the
package, or one from `normalgan export`. The drawings are those in ``examples/sketches``, resized to each side
beforehand. `--pen 6` instead draws one ellipse inside another at each size, with a pen of 6 pixels.
Prints JSON: the median milliseconds of each step.
"""

import argparse
import json
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np
from machine import describe

from normalgan.inference import pipeline, preparation
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.reading.picture import Picture, fitted, read_picture
from normalgan.weights.shipped import find_model

SKETCHES = Path(__file__).parents[1] / "examples" / "sketches"


class Clock:
    """Adds up the processor time of the functions it wraps."""

    def __init__(self) -> None:
        self.taken: dict[str, float] = defaultdict(float)

    def wrap(self, name: str, work: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function wrapped, its time counted under a name."""

        def timed(*args: Any, **settings: Any) -> Any:
            start = time.process_time()
            try:
                return work(*args, **settings)
            finally:
                self.taken[name] += 1000 * (time.process_time() - start)

        return timed

    @contextmanager
    def steps(self) -> Iterator[None]:
        """Time the steps of the preparation."""
        names = ("clean", "read", "decide", "render_model_input")
        patches = [
            patch.object(preparation, name, self.wrap(name, getattr(preparation, name))) for name in names
        ]
        for each in patches:
            each.start()
        try:
            yield
        finally:
            for each in patches:
                each.stop()


def once(drawing: Picture, backend: OnnxBackend) -> dict[str, float]:
    """Return the milliseconds of each step of one drawing."""
    clock = Clock()
    start = time.process_time()
    with clock.steps():
        prepared = preparation.prepare(drawing, backend.size, line_widths=backend.line_widths)
    predicted = clock.wrap("network", backend.predict)(prepared.model_input, prepared.hints)
    upsample = clock.wrap("upsample", backend.upsample)
    clock.wrap("finish", pipeline.finish)(prepared, *predicted, upsample)
    total = 1000 * (time.process_time() - start)
    taken = dict(clock.taken)
    taken["finish"] -= taken["upsample"]
    taken["other"] = total - sum(taken.values())
    return {**taken, "total": total}


def ellipses(side: int, width: int) -> Picture:
    """Return one ellipse inside another, drawn with a pen of ``width`` pixels."""
    paper = np.full((side, side, 3), 255, np.uint8)
    for share in (0.2, 0.33):
        radii = round(share * side), round(1.15 * share * side)
        cv2.ellipse(paper, (side // 2, side // 2), radii, 0, 0, 360, (0, 0, 0), width, cv2.LINE_AA)
    return Picture((paper / np.float32(255)).astype(np.float32), None)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("model", nargs="?")
    parser.add_argument("--sides", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--pen", type=int, default=0)
    given = parser.parse_args()
    cv2.setNumThreads(1)
    backend = OnnxBackend(find_model(given.model), threads=1)
    drawings = [read_picture(path) for path in sorted(SKETCHES.glob("*.png"))]
    figures: dict[str, Any] = {}
    for side in given.sides:
        if given.pen:
            sized = [ellipses(side, given.pen)]
        else:
            sized = [each.resized(fitted(each.size, side)) for each in drawings]
        for each in sized:
            once(each, backend)
        taken = [once(each, backend) for _ in range(given.rounds) for each in sized]
        figures[str(side)] = {key: round(statistics.median(t[key] for t in taken), 1) for key in taken[0]}
    print(
        json.dumps(
            {**figures, "machine": describe("onnxruntime", "numpy", "opencv-python-headless")}, indent=1
        )
    )


if __name__ == "__main__":
    main()
