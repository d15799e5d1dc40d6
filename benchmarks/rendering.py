"""Measures how fast samples are rendered, for every renderer and line style and for several sizes and meshes.

benchmarks/rendering.py [--quick] [--endurance 10000] [-o docs/results/rendering.json]

Every row is a process of its own, restricted to one core. All rows of one size and mesh run side by side and
take turns, so that other load on the machine affects all of them. Each figure is the median of the rounds.
"""

import argparse
import inspect
import json
import os
import tempfile
import zlib
from collections.abc import Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import Any

from machine import ONE_THREAD, describe

os.environ.update(ONE_THREAD)  # before NumPy and others are imported, here and in every child process

import numpy as np
from sampler import Row, endure, serve, spin, write

from normalgan.animals import SPECIES
from normalgan.animals.meshing import to_mesh
from normalgan.rendering import RENDERERS
from normalgan.rendering.lines import LINE_DRAWINGS

ANIMALS = {"horse": 2, "lion": 3, "cow": 2}
DEFAULT = "SuggestiveContours"
PACKAGES = ("numpy", "scipy", "opencv-python-headless", "pyrender", "embreex")
SPAWN = get_context("spawn")  # never fork: a child would share the parent's OpenGL


def make_meshes(faces: Sequence[int], folder: Path) -> None:
    """Write embedded animals at resolutions that give about these numbers of faces."""
    for species, seed in ANIMALS.items():
        for count in faces:
            rng = np.random.default_rng([zlib.crc32(species.encode()), seed])
            mesh = to_mesh(species, SPECIES[species].grow(None, rng), round(1.1 * count))
            write(mesh, folder / f"{count}-{species}.npz")


def needs_settings(cls: type) -> bool:
    """Return whether a class requires settings, as a mixture of other styles does."""
    return any(each.default is each.empty for each in inspect.signature(cls).parameters.values())


def start(target: Any, *arguments: Any) -> tuple[Any, Connection]:
    """Start a process, and return it with the connection to it."""
    ours, theirs = SPAWN.Pipe()
    process = SPAWN.Process(target=target, args=(*arguments, theirs), daemon=True)  # ends with this process
    process.start()
    theirs.close()
    return process, ours


def measure(rows: Sequence[Row], folder: str, rounds: int, seconds: float) -> Iterator[dict[str, Any]]:
    """Measure rows in turns, and yield their figures."""
    children = [start(serve, row, folder) for row in rows]
    for _, channel in children:
        channel.recv()  # ready
    figures: list[list[tuple[int, float, float]]] = [[] for _ in rows]
    for _ in range(rounds):
        for (_, channel), found in zip(children, figures, strict=True):
            channel.send(seconds)
            found.append(channel.recv())
    for row, (process, channel), found in zip(rows, children, figures, strict=True):
        channel.send(0)
        peak = channel.recv()
        process.join()
        yield {
            **vars(row),
            "samples_per_second": round(median(number / wall for number, wall, _ in found), 2),
            "samples_per_cpu_second": round(median(number / cpu for number, _, cpu in found), 2),
            "peak_memory_mb": round(peak),
            "samples": sum(number for number, _, _ in found),
        }


def speed_up(rounds: int, seconds: float, target: Any, *arguments: Any) -> dict[str, float]:
    """Return the throughput of two processes together, relative to one alone."""
    children = [start(target, *arguments) for _ in range(2)]
    for _, channel in children:
        channel.recv()  # ready
    alone: list[float] = []
    together: list[float] = []
    for _ in range(rounds):
        for team, rates in ((children[:1], alone), (children, together)):
            for _, channel in team:
                channel.send(seconds)
            rates.append(sum(number / wall for number, wall, _ in (channel.recv() for _, channel in team)))
    for process, channel in children:
        channel.send(0)
        channel.recv()
        process.join()
    one, two = median(alone), median(together)
    return {"one": round(one, 2), "two": round(two, 2), "times": round(two / one, 3)}


def endurance(row: Row, folder: str, number: int) -> dict[str, Any]:
    """Return the memory that a process holds after each twentieth of ``number`` samples."""
    process, channel = start(endure, row, folder, number)
    held = channel.recv()
    process.join()
    return {**vars(row), "samples": number, "held_mb": [round(each, 1) for each in held]}


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Return the rows as Markdown: samples per second and core, and peak memory in MB."""
    groups = sorted({(row["size"], row["faces"]) for row in rows})
    heads = [f"{size} px, {faces // 1000}k" for size, faces in groups]
    lines = ["| renderer | lines | " + " | ".join(heads) + " |", "| --- | --- |" + " --- |" * len(heads)]
    for renderer, style in dict.fromkeys((row["renderer"], row["lines"]) for row in rows):
        cells = {(r["size"], r["faces"]): r for r in rows if (r["renderer"], r["lines"]) == (renderer, style)}
        found = [f"{cells[g]['samples_per_second']:.1f} ({cells[g]['peak_memory_mb']})" for g in groups]
        lines.append(f"| {renderer} | {style or 'maps alone'} | " + " | ".join(found) + " |")
    return "\n".join(lines)


def main() -> None:
    """Measure, print the tables and write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, help="JSON file to write")
    parser.add_argument("--quick", action="store_true", help="256 pixels, 10k faces, two short rounds")
    parser.add_argument("--endurance", type=int, default=0, help="also render N samples in one process")
    parser.add_argument("--only", nargs="*", help="line styles; 'maps' for the maps alone (default: all)")
    options = parser.parse_args()
    sizes, faces = ((256,), (10_000,)) if options.quick else ((256, 512, 1024), (10_000, 50_000))
    rounds, seconds = (2, 0.4) if options.quick else (7, 1.0)
    styles = [None, *(cls.__name__ for cls in LINE_DRAWINGS if not needs_settings(cls))]
    if options.only is not None:
        styles = [style for style in styles if (style or "maps") in options.only]
    result: dict[str, Any] = {
        "machine": describe(*PACKAGES),
        "rounds": rounds,
        "seconds": seconds,
        "rows": [],
    }
    with tempfile.TemporaryDirectory() as folder:
        make_meshes(faces, Path(folder))
        for size in sizes:
            for count in faces:
                rows = [Row(name, style, size, count) for name in RENDERERS.names() for style in styles]
                result["rows"] += measure(rows, folder, rounds, seconds)
        usual = Row("PyrenderRenderer", DEFAULT, 256, faces[0])
        result["two_workers"] = {**vars(usual), **speed_up(rounds, 2 * seconds, serve, usual, folder)}
        result["two_loops"] = speed_up(rounds, seconds, spin)  # the maximum that the machine's cores allow
        if options.endurance:
            result["endurance"] = endurance(usual, folder, options.endurance)
    print(table(result["rows"]))
    print(f"\ntwo workers: {result['two_workers']['times']} times one")
    print(f"two plain loops: {result['two_loops']['times']} times one")
    if options.endurance:
        print(f"memory in MB, after each twentieth: {result['endurance']['held_mb']}")
    if options.output:
        options.output.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
