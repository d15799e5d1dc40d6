"""Times `normalgan generate`: a cold start to a written map, and a batch against bare inference.

generate.py MODEL [DRAWINGS] [ROUNDS]: a model from `normalgan export`, the number of drawings in a batch, and
how often each is timed. Prints JSON.

generate.py MODEL --memory 10 300 [--side 256]: the peak memory of batches with these numbers of drawings.
Each batch runs in a process of its own; if the process that decodes for it needs more, that peak counts.
"""

import argparse
import json
import os
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

from normalgan.cli.generate.command import run
from normalgan.inference.network.onnx_backend import OnnxBackend
from normalgan.inference.parallel import stream
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import read_picture

SKETCHES = Path(__file__).parents[1] / "examples" / "sketches"
SIDE = 256


def timed(what: Callable[[], object], count: int) -> tuple[float, float]:
    """Return the wall-clock and the processor time of a call, in seconds per drawing of ``count``."""
    busy, start = time.process_time(), time.perf_counter()
    what()
    return (time.perf_counter() - start) / count, (time.process_time() - busy) / count


def summary(times: list[tuple[float, float]]) -> dict[str, float]:
    """Return the medians in milliseconds per drawing."""
    wall, busy = (1000 * statistics.median(each) for each in zip(*times, strict=True))
    return {"wall_ms": round(wall, 2), "processor_ms": round(busy, 2)}


def ratio(ours: list[tuple[float, float]], bare: list[tuple[float, float]]) -> float:
    """Return the median over the rounds of the ratio of wall-clock times."""
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


def draw(count: int, folder: Path, width: int = SIDE, height: int = SIDE) -> list[Path]:
    """Write ``count`` drawings, no two alike, and return their files."""
    originals = sorted(SKETCHES.glob("*.png"))
    drawings = []
    for i in range(count):
        with Image.open(originals[i % len(originals)]) as image:
            shifted = np.roll(
                np.asarray(image.convert("L").resize((width, height))), i // len(originals), axis=1
            )
        drawings.append(folder / f"{i:04d}.png")
        Image.fromarray(shifted).save(drawings[-1])
    return drawings


def peak(model: Path, drawings: list[Path], folder: Path) -> tuple[float, float, float]:
    """Return the peak memory (MB) of a batch in its own process, its wall-clock and its processor seconds."""
    given = map(str, [*drawings, "-o", folder, "--model", model])
    command = [sys.executable, "-m", "normalgan", "generate", *given]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"the batch of {len(drawings)} drawings failed")
    seconds = time.perf_counter() - start
    return round(used.ru_maxrss / 1024, 1), round(seconds, 2), round(used.ru_utime + used.ru_stime, 2)


def memory(model: Path, counts: list[int], width: int, height: int) -> None:
    """Print the peak memory and the time of batches of these sizes, the start of the command included."""
    with TemporaryDirectory() as temporary:
        drawings = draw(max(counts), Path(temporary), width, height)
        peaks = {str(each): peak(model, drawings[:each], Path(temporary) / str(each)) for each in counts}
    machine = describe("numpy", "onnxruntime", "opencv-python-headless")
    names = ("peak_mb", "seconds", "processor_seconds")
    found = {count: dict(zip(names, each, strict=True)) for count, each in peaks.items()}
    print(json.dumps({"pixels": [width, height], "batches": found, "machine": machine}, indent=1))


def main(model: Path, count: int = 64, rounds: int = 5) -> None:
    """Print the figures."""
    with TemporaryDirectory() as temporary:
        folder = Path(temporary)
        drawings = draw(count, folder)
        cold_starts = [cold(model, drawings[0], folder / "cold") for _ in range(rounds)]
        session, single = OnnxBackend(model), OnnxBackend(model, threads=1)
        pictures = map(read_picture, drawings)
        seen = [prepare(each, session.size, line_widths=session.line_widths).model_input for each in pictures]
        session.predict(seen[0])
        single.predict(seen[0])
        bare: list[tuple[float, float]] = []
        alone, crowd, batch = bare.copy(), bare.copy(), bare.copy()
        arguments = [*map(str, drawings), "-o", str(folder / "batch"), "--model", str(model)]
        for _ in range(rounds):  # in turns, so that a busy machine slows both
            bare.append(timed(lambda: [session.predict(each) for each in seen], count))
            alone.append(timed(lambda: [single.predict(each) for each in seen], count))
            crowd.append(timed(lambda: list(stream(seen, single.predict)), count))
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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=Path)
    parser.add_argument("count", type=int, nargs="?", default=64)
    parser.add_argument("rounds", type=int, nargs="?", default=5)
    parser.add_argument("--memory", type=int, nargs="+", help="drawings of each batch")
    parser.add_argument(
        *("--side", "--sides"),
        dest="sides",
        type=int,
        nargs="+",
        default=[SIDE],
        help="with --memory: pixels of a drawing, one side or width and height",
    )
    asked = parser.parse_args()
    if asked.memory:
        memory(asked.model, asked.memory, asked.sides[0], asked.sides[-1])
    else:
        main(asked.model, asked.count, asked.rounds)
