"""Times `normalgan generate`: a cold start to a written map, and a batch against bare inference.

generate.py MODEL [DRAWINGS] [ROUNDS]: a model by `normalgan export`, how many drawings a batch has, and
how often each is timed. Prints JSON.
"""

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from machine import describe
from PIL import Image

from normalgan.commands.generate import run
from normalgan.inference.picture import read_picture
from normalgan.inference.preparation import prepare
from normalgan.inference.session import Model

SKETCHES = Path(__file__).parents[1] / "examples" / "sketches"
SIDE = 256


def seconds(what: object) -> float:
    """Return how long calling it takes."""
    start = time.perf_counter()
    what()  # type: ignore[operator]
    return time.perf_counter() - start


def cold(model: Path, drawing: Path, folder: Path) -> float:
    """Return the wall-clock time of the command in a fresh process."""
    command = [sys.executable, "-m", "normalgan", "generate", drawing, "-o", folder, "--model", model]
    return seconds(lambda: subprocess.run(command, check=True, capture_output=True))


def main(model: Path, count: int = 64, rounds: int = 5) -> None:
    """Print the figures."""
    with TemporaryDirectory() as temporary:
        folder = Path(temporary)
        originals = sorted(SKETCHES.glob("*.png"))
        drawings = []
        for i in range(count):  # no two alike
            with Image.open(originals[i % len(originals)]) as image:
                shifted = np.roll(
                    np.asarray(image.convert("L").resize((SIDE, SIDE))), i // len(originals), axis=1
                )
            drawings.append(folder / f"{i:04d}.png")
            Image.fromarray(shifted).save(drawings[-1])
        cold_starts = [cold(model, drawings[0], folder / "cold") for _ in range(rounds)]
        session = Model(model)
        seen = [prepare(read_picture(path), session.size).seen for path in drawings]
        session.paint(seen[0])
        bare, batch = [], []
        arguments = [*map(str, drawings), "-o", str(folder / "batch"), "--model", str(model)]
        for _ in range(rounds):  # by turns, so that a busy machine slows both
            bare.append(seconds(lambda: [session.paint(each) for each in seen]) / count)
            load = seconds(lambda: Model(model))
            batch.append((seconds(lambda: run(arguments)) - load) / count)
    figures = {
        "drawings": count,
        "drawing_pixels": SIDE,
        "model_pixels": session.size,
        "cold_start_s": {"median": statistics.median(cold_starts), "all": cold_starts},
        "bare_ms": 1000 * statistics.median(bare),
        "batch_ms": 1000 * statistics.median(batch),
        "batch_over_bare": statistics.median(b / a for a, b in zip(bare, batch, strict=True)),
        "machine": describe("numpy", "onnxruntime", "opencv-python-headless"),
    }
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:4]))
