"""A scheduler and workers as processes of their own, that can be killed and join late, and what they do."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from distributed import Client
from toys import BallRenderer, Octahedron, recipe

from normalgan.data.render import render_samples
from normalgan.rendering.cameras import Camera
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.samples import Recipe

HERE = Path(__file__).parent


@dataclass(frozen=True)
class MoodyRenderer(BallRenderer):
    """Raises at the mesh ``fails_at``, unless the file ``mended`` is there."""

    fails_at: str = ""
    mended: str = ""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        if mesh.name == self.fails_at and not Path(self.mended or "/nowhere").exists():
            raise ArithmeticError(f"{mesh.name} has no inside")
        return super().render(mesh, camera, size)


@dataclass
class DaskCluster:
    """A scheduler and its workers."""

    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def address(self) -> str:
        return str(self.folder / "scheduler.json")

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        process = self._start("scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", self.address)
        wait_for(Path(self.address).is_file)
        return process

    def start_worker(self, *more: str, threads: int = 1, nanny: bool = False) -> subprocess.Popen[bytes]:
        keeper = "--nanny" if nanny else "--no-nanny"
        options = ("--nthreads", str(threads), "--no-dashboard", "--local-directory", str(self.folder))
        return self._start("worker", "--scheduler-file", self.address, keeper, *options, *more)

    def kill_last_worker(self, process: subprocess.Popen[bytes]) -> None:
        """Kill the only worker, and wait until the scheduler knows: until then it names it to others."""
        process.kill()
        client: Any = Client(scheduler_file=self.address, set_as_default=False)  # type: ignore[no-untyped-call]
        with client:
            wait_for(lambda: not client.scheduler_info(n_workers=-1)["workers"])

    def _start(self, *arguments: str) -> subprocess.Popen[bytes]:
        paths = os.pathsep.join([str(HERE), str(HERE / "jobs"), os.environ.get("PYTHONPATH", "")])
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments],
            env={**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self.processes.append(process)
        return process


@contextmanager
def start_cluster(folder: Path) -> Iterator[DaskCluster]:
    """A scheduler without workers; all that was started is ended."""
    folder.mkdir(parents=True, exist_ok=True)
    made = DaskCluster(folder)
    try:
        made.start_scheduler()
        yield made
    finally:
        for process in made.processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def wait_for(true: Callable[[], bool], seconds: float = 90) -> None:
    """Wait until a function returns true."""
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)


SOURCES = {
    "train": [Octahedron("a"), Octahedron("b", 0.3), Octahedron("c", 0.6), Octahedron("d", 0.4)],
    "val": [],
    "test": [Octahedron("e", 0.8)],
}
VIEWS = 18  # 72 samples to train on are three shards, 18 to test on are one


def render(cache: Path, cluster: str | None = None, made_by: Recipe | None = None, **renderer: Any) -> Path:
    """Render the toys and return the one folder of the data set."""
    used = made_by or recipe(**renderer)
    render_samples(str(cache), SOURCES, VIEWS, used, progress=False, cluster=cluster)
    (folder,) = cache.iterdir()
    return folder


def finished(cache: Path) -> int:
    return len(list(cache.glob("*/done/*/*.json")))
