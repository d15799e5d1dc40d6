import os
import signal
import threading
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from dask_processes import DaskCluster, finished, render, start_cluster, wait_for
from distributed import Client
from toys import Octahedron, contents, recipe

from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.tasks import MeshTask, ShardTask, render_shard
from normalgan.data.render import render_samples
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError, RunError

pytestmark = pytest.mark.slow  # starts processes of its own


@pytest.fixture(scope="module", name="pair")
def make_pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskCluster]:
    """A scheduler and two workers that live as long as the tests of this file."""
    with start_cluster(tmp_path_factory.mktemp("pair")) as made:
        made.start_worker()
        made.start_worker()
        yield made


def test_a_cluster_writes_the_same_bytes_as_this_process(
    tmp_path: Path, pair: DaskCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # where the command was given, which relative paths refer to
    alone = render(tmp_path / "0")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        together = render(Path("1"), pair.address)
    assert alone.name == together.name
    assert contents(alone) == contents(tmp_path / together)
    assert finished(tmp_path / "1") == 4


def test_a_cluster_finds_and_repairs_damage(tmp_path: Path, pair: DaskCluster) -> None:
    folder = render(tmp_path)
    whole = contents(folder)
    path = folder / "samples.zarr" / "train" / "sketch" / "c" / "1" / "0" / "0"
    content = bytearray(path.read_bytes())
    content[7] ^= 1
    path.write_bytes(content)
    with pytest.warns(UserWarning, match=r"damaged, and rendered again: shard 1 of train in "):
        render(tmp_path, pair.address)
    assert contents(folder) == whole


def test_one_worker_is_killed_and_one_joins_late_and_nothing_changes(tmp_path: Path) -> None:
    go = tmp_path / "go"
    slow: dict[str, Any] = {"waits_at": "d", "until": str(go)}  # of four shards, two
    with start_cluster(tmp_path / "dask") as dask_cluster:
        doomed = dask_cluster.start_worker()
        died_at = []

        def meddle() -> None:
            wait_for(lambda: finished(tmp_path / "cache") > 0)
            dask_cluster.start_worker()
            os.kill(doomed.pid, signal.SIGKILL)
            died_at.append(finished(tmp_path / "cache"))
            go.touch()

        thread = threading.Thread(target=meddle)
        thread.start()
        folder = render(tmp_path / "cache", dask_cluster.address, **slow)
        thread.join()
    assert doomed.wait() == -signal.SIGKILL
    assert 0 < died_at[0] < 4
    assert contents(folder) == contents(render(tmp_path / "alone", **slow))


def test_workers_of_another_version_are_refused(tmp_path: Path) -> None:
    go = tmp_path / "go"
    slow: dict[str, Any] = {"waits_at": "d", "until": str(go)}  # of four shards, two
    preload = tmp_path / "other.py"
    preload.write_text("import normalgan.rendering.samples as s\ns.RENDERING_VERSION = -7\n")
    with start_cluster(tmp_path / "dask") as dask_cluster:
        other = dask_cluster.start_worker("--preload", str(preload))
        with pytest.raises(
            InputError,
            match=r"^the worker tcp://\S+ of .* cannot be used: it has the rendering -7, not \d+\.$",
        ):
            render(tmp_path / "cache", dask_cluster.address)
        assert not (tmp_path / "cache").exists()
        dask_cluster.kill_last_worker(other)
        dask_cluster.start_worker()

        with pytest.warns(  # noqa: PT031 -- who meddles looks at what was told
            UserWarning, match=r"tcp://\S+ has joined but cannot be used: it has the rendering -7, not "
        ) as told:

            def meddle() -> None:
                try:
                    wait_for(lambda: finished(tmp_path / "cache") > 0)
                    dask_cluster.start_worker("--preload", str(preload))
                    wait_for(lambda: len(told) > 0)
                finally:
                    go.touch()

            thread = threading.Thread(target=meddle)
            thread.start()
            folder = render(tmp_path / "cache", dask_cluster.address, **slow)
            thread.join()
    assert contents(folder) == contents(render(tmp_path / "alone", **slow))


def test_a_worker_without_the_package_or_with_threads_is_refused(tmp_path: Path) -> None:
    blocker = tmp_path / "block.py"
    blocker.write_text("import sys\nsys.modules['normalgan.data.jobs.cluster_worker'] = None\n")
    with start_cluster(tmp_path / "dask") as dask_cluster:
        bare = dask_cluster.start_worker("--preload", str(blocker))
        with pytest.raises(InputError, match="cannot be used: it has no normalgan, or an older one"):
            render(tmp_path / "cache", dask_cluster.address)
        dask_cluster.kill_last_worker(bare)
        dask_cluster.start_worker(threads=2)
        with pytest.raises(InputError, match="it has 2 threads, not 1: a renderer belongs to one"):
            render(tmp_path / "cache", dask_cluster.address)


def test_finished_shards_are_kept_when_the_scheduler_goes(tmp_path: Path) -> None:
    with start_cluster(tmp_path / "dask") as dask_cluster:
        dask_cluster.start_worker()

        def meddle() -> None:
            wait_for(lambda: finished(tmp_path / "cache") > 0)
            dask_cluster.processes[0].kill()

        thread = threading.Thread(target=meddle)
        thread.start()
        with pytest.raises(RunError, match=r"^the scheduler at .* is gone; finished samples are kept"):
            render(tmp_path / "cache", dask_cluster.address, waits_at="d", until=str(tmp_path / "never"))
        thread.join()
    assert 0 < finished(tmp_path / "cache") < 4


def test_a_result_that_is_lost_with_its_worker_is_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    futures = []
    submit = Client.submit

    def note(client: Client, *call: Any, **how: Any) -> Any:
        futures.append(submit(client, *call, **how))
        return futures[-1]

    monkeypatch.setattr(Client, "submit", note)
    with start_cluster(tmp_path) as dask_cluster:
        doomed = dask_cluster.start_worker()
        with Cluster(dask_cluster.address) as pool:
            outcomes = pool.run(abs, [-1, 2, -3])
            first = next(outcomes)
            wait_for(lambda: all(future.status == "finished" for future in futures))
            doomed.kill()
            wait_for(lambda: any(future.status == "lost" for future in futures))
            dask_cluster.start_worker()
            assert sorted([first, *outcomes]) == [(-3, 3), (-1, 1), (2, 2)]


@dataclass(frozen=True)
class Local(Octahedron):
    """A mesh that is another one in every process, as a file may be on another machine."""

    def fingerprint(self) -> str:
        return f"{super().fingerprint()} {os.getpid()}"


def test_a_mesh_that_a_worker_does_not_see_stops_the_run_with_its_address(
    tmp_path: Path, pair: DaskCluster
) -> None:
    sources = {"train": [Local("a")]}
    with pytest.raises(InputError, match=r"^a on \S+ has changed .* machine \(worker tcp://\S+\)\.$"):
        render_samples(str(tmp_path), sources, 2, recipe(), progress=False, cluster=pair.address)
    assert finished(tmp_path) == 0


def test_a_store_that_a_worker_does_not_see_is_named(tmp_path: Path) -> None:
    shard = Layout(("a",), 2, 16).shard("train", 0)
    source = Octahedron("a")
    task = ShardTask(str(tmp_path), shard, recipe(), {"a": MeshTask(source, source.fingerprint())})
    with pytest.raises(
        InputError, match=rf"does not see {tmp_path}; the cache must be a folder that all machines"
    ):
        render_shard(task)
    ShardedSamples(str(tmp_path), "train", Layout(("a",), 2, 16)).create()
    assert render_shard(task) == {}
