"""One row of the rendering benchmark, in its own process: renders on request, and reports how fast."""

import resource
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import count
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from normalgan.rendering import RENDERERS, Mesh, Views
from normalgan.rendering.lines import LINE_DRAWINGS
from normalgan.rendering.samples import Recipe, sample_rng

WARM_UP = 3  # samples: compiles shaders, builds search trees, measures curvature


@dataclass(frozen=True)
class Row:
    """The settings of one row.

    Args:
        renderer: name of a renderer.
        lines: name of a line style; None for the maps alone, without a sketch.
        size: side in pixels.
        faces: approximate number of faces of the meshes.
    """

    renderer: str
    lines: str | None
    size: int
    faces: int

    @property
    def title(self) -> str:
        """Return the name of the row in the table."""
        return "maps alone" if self.lines is None else self.lines


def serve(row: Row, folder: str, channel: Connection) -> None:
    """Render for the number of seconds in each message and answer with figures, until a message says 0."""
    work = samples(row, Path(folder))
    for _ in range(WARM_UP):
        next(work)
    channel.send("ready")
    answer(channel, work)
    channel.send(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def spin(channel: Connection) -> None:
    """Keep a core busy with nothing else, answering like `serve`, to measure what a second core adds."""
    channel.send("ready")
    answer(channel, (sum(range(100_000)) for _ in count()))
    channel.send(0)


def answer(channel: Connection, work: Iterator[object]) -> None:
    """Take steps for the seconds in each message, and send their number and time, until a message says 0."""
    while seconds := channel.recv():
        number, wall, cpu = 0, time.perf_counter(), time.process_time()
        while number == 0 or time.perf_counter() - wall < seconds:
            next(work)
            number += 1
        channel.send((number, time.perf_counter() - wall, time.process_time() - cpu))


def samples(row: Row, folder: Path, views_per_mesh: int = 50) -> Iterator[None]:
    """Render one sample at each step, endlessly, with a new mesh after every ``views_per_mesh``."""
    renderer = _named(RENDERERS, row.renderer)()
    files = sorted(folder.glob(f"{row.faces}-*.npz"))
    recipe = Recipe(Views(), renderer, _named(LINE_DRAWINGS, row.lines or "OccludingContours")(), row.size)
    for turn in count():
        mesh = read(files[turn % len(files)])
        for index in range(turn * views_per_mesh, (turn + 1) * views_per_mesh):
            if row.lines is None:
                camera = recipe.views.camera(mesh, sample_rng(0, mesh.name, index, "views"))
                renderer.render(mesh, camera, row.size)
            else:
                recipe.render(mesh, index)
            yield


def resident() -> float:
    """Return the memory in MB that this process holds now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


def endure(row: Row, folder: str, number: int, channel: Connection) -> None:
    """Render ``number`` samples, and answer with the memory after each twentieth of them."""
    work, held = samples(row, Path(folder)), []
    for index in range(number):
        next(work)
        if (index + 1) % max(number // 20, 1) == 0:
            held.append(resident())
    channel.send(held)


def write(mesh: Mesh, path: Path) -> None:
    """Write a mesh for `read`."""
    np.savez(path, **asdict(mesh))


def read(path: Path) -> Mesh:
    """Return the mesh that `write` wrote."""
    with np.load(path) as stored:
        return Mesh(str(stored["name"]), stored["vertices"], stored["faces"], stored["normals"])


def _named(registry, name: str):  # type: ignore[no-untyped-def]
    return {cls.__name__: cls for cls in registry}[name]
