"""Times `normalgan generate`: a cold start to a written map, and a batch against bare inference.

generate.py MODEL [DRAWINGS] [ROUNDS]: a model by `normalgan export`, how many drawings a batch has, and
how often each is timed. Prints JSON.
"""

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from machine import describe
from PIL import Image

from normalgan.commands.generate import run
from normalgan.painting.onnx_backend import OnnxBackend
from normalgan.painting.parallel import stream
from normalgan.painting.picture import read_picture
from normalgan.painting.preparation import prepare

SKETCHES = Path(__file__).parents[1] / "examples" / "sketches"
SIDE = 256


def timed(what: Callable[[], object], count: int) -> tuple[float, float]:
    """Return how long calling it takes and how long all processors work on it, seconds for each of many."""
    busy, start = time.process_time(), time.perf_counter()
    what()
    return (time.perf_counter() - start) / count, (time.process_time() - busy) / count


def summary(times: list[tuple[float, float]]) -> dict[str, float]:
    """Return the medians, in milliseconds a drawing."""
    wall, busy = (1000 * statistics.median(each) for each in zip(*times, strict=True))
    return {"wall_ms": round(wall, 2), "processor_ms": round(busy, 2)}


def ratio(ours: list[tuple[float, float]], bare: list[tuple[float, float]]) -> float:
    """Return the median ratio of the wall-clock times of each round."""
    return round(statistics.median(a[0] / b[0] for a, b in zip(ours, bare, strict=True)), 3)


def cold(model: Path, drawing: Path, folder: Path) -> float:
    """Return the wall-clock time of the command in a fresh process."""
    command: list[str | Path] = [
        sys.executable,
        "-m",
        "normalgan",
        "generate",
        drawing,
        "-o",
        folder,
        "--model",
        model,
    ]
    return timed(lambda: subprocess.run(command, check=True, capture_output=True), 1)[0]


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
        session, single = OnnxBackend(model), OnnxBackend(model, threads=1)
        seen = [prepare(read_picture(path), session.size).seen for path in drawings]
        session.paint(seen[0])
        single.paint(seen[0])
        bare: list[tuple[float, float]] = []
        alone, crowd, batch = bare.copy(), bare.copy(), bare.copy()
        arguments = [*map(str, drawings), "-o", str(folder / "batch"), "--model", str(model)]
        for _ in range(rounds):  # by turns, so that a busy machine slows both
            bare.append(timed(lambda: [session.paint(each) for each in seen], count))
            alone.append(timed(lambda: [single.paint(each) for each in seen], count))
            crowd.append(timed(lambda: list(stream(seen, single.paint)), count))
            load = timed(lambda: OnnxBackend(model, threads=1), count)
            with redirect_stdout(StringIO()):
                whole = timed(lambda: run(arguments), count)
            batch.append((whole[0] - load[0], whole[1] - load[1]))
    figures = {
        "drawings": count,
        "drawing_pixels": SIDE,
        "model_pixels": session.size,
        "cold_start_s": {"median": statistics.median(cold_starts), "all": cold_starts},
        "bare_one_at_a_time_on_all_cores": summary(bare),
        "bare_one_at_a_time_on_one_core": summary(alone),
        "bare_one_a_core": summary(crowd),
        "batch": summary(batch),
        "batch_over_bare": {
            "one_at_a_time_on_all_cores": ratio(batch, bare),
            "one_at_a_time_on_one_core": ratio(batch, alone),
            "one_a_core": ratio(batch, crowd),
        },
        "machine": describe("numpy", "onnxruntime", "opencv-python-headless"),
    }
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:4]))
