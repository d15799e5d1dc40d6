"""Times what decoding in a child process adds: to a picture, and to a cold start of `normalgan generate`.

decoding.py [ROUNDS [STARTS]]: how often each picture and each start is timed. The same decoder runs here and
in the child by turns, so that both meet the same load: "added" is the median of the differences, "ratio" that
of the quotients, round by round, and "least_added" what the fastest round there takes more than the fastest
here. Processor time counts all processes. On a busy machine "added" holds the waiting for a processor.
Prints JSON.
"""

import io
import json
import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from machine import describe
from PIL import Image

from normalgan import decoding
from normalgan.decoding import worker
from normalgan.inference.network.onnx_backend import SHIPPED

SKETCH = Path(__file__).parents[1] / "examples" / "sketches" / "fox.png"
SIDES = (256, 512, 1024, 2048)
HERE = """
import sys
import numpy as np
from normalgan import decoding
from normalgan.inference.reading import drawings
from normalgan.decoding import worker
def decode(name, content, sides, svg_side, longest=None, grey=False):
    image, full = worker.decode(content, *sides, svg_side, longest or 0, grey)
    return decoding.Decoded(np.asarray(image), full[::-1])
decoding.start = lambda: None
drawings.decode = decode
from normalgan.cli.generate import run
sys.exit(run(sys.argv[1:]))
"""
"""The command with the same decoder in its own process."""
THERE = "import sys; from normalgan.cli.generate import run; sys.exit(run(sys.argv[1:]))"


def waited() -> float:
    """Return the seconds by the clock."""
    return time.perf_counter()


def worked() -> float:
    """Return the seconds of processor time that ended processes took."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def timed(what: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return how long calling it takes, in milliseconds."""
    start = clock()
    what()
    return 1000 * (clock() - start)


def compared(
    here: Callable[[], object],
    there: Callable[[], object],
    rounds: int,
    clock: Callable[[], float] = waited,
) -> dict[str, float]:
    """Return the medians of both in milliseconds, and how much more the second takes, round by round."""
    here(), there()
    times = [(timed(here, clock), timed(there, clock)) for _ in range(rounds)]
    return {
        "here_ms": round(statistics.median(a for a, _ in times), 2),
        "child_ms": round(statistics.median(b for _, b in times), 2),
        "added_ms": round(statistics.median(b - a for a, b in times), 2),
        "least_added_ms": round(min(b for _, b in times) - min(a for a, _ in times), 2),
        "ratio": round(statistics.median(b / a for a, b in times), 3),
    }


def pictures(rounds: int) -> dict[str, dict[str, float]]:
    """Return what the child adds to a drawing of several sizes, as a scan and with opacity."""
    found = {}
    with Image.open(SKETCH) as original:
        grey = original.convert("L")
    for side in SIDES:
        scan = grey.resize((side, side))
        for name, image in (("grey", scan), ("RGBA", Image.merge("RGBA", [scan, scan, scan, scan]))):
            file = io.BytesIO()
            image.save(file, "PNG")
            content = file.getvalue()

            def here(content: bytes = content) -> object:
                return np.asarray(worker.decode(content, 8, 8192, 1024, 0, False)[0])

            def there(content: bytes = content) -> object:
                return decoding.decode("a", content, (8, 8192), 1024).pixels

            found[f"{side} {name}"] = compared(here, there, rounds)
    return found


def cold_start(rounds: int, clock: Callable[[], float]) -> dict[str, float]:
    """Return what the child adds to the command in a fresh process, from its start to the written map."""
    with TemporaryDirectory() as folder:
        arguments = [str(SKETCH), "-o", folder, "--model", str(SHIPPED)]

        def run(program: str) -> object:
            return subprocess.run(
                [sys.executable, "-c", program, *arguments], check=True, capture_output=True
            )

        return compared(lambda: run(HERE), lambda: run(THERE), rounds, clock)


def main(rounds: int = 25, starts: int = 9) -> None:
    """Print the figures, with the load of the machine before and after."""
    load = round(os.getloadavg()[0], 1)
    figures = {
        "rounds": rounds,
        "pictures": pictures(rounds),
        "starts": starts,
        "cold_start": cold_start(starts, waited),
        "cold_start_processor": cold_start(starts, worked),
        "load": [load, round(os.getloadavg()[0], 1)],
        "machine": describe("numpy", "pillow", "resvg-py", "onnxruntime"),
    }
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
