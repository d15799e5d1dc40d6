from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from dask_processes import SOURCES
from toys import recipe

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.tasks import DEADLY, MeshTask, ShardTask, render_shards, validate_sources
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import RunError

MESHES = {source.name: MeshTask(source, source.fingerprint()) for source in SOURCES["train"]}


class Unlucky(Pool):
    """A pool in which a task with a deadly mesh dies, and takes all beside it along."""

    room = 100

    def __init__(self, *deadly: str) -> None:
        self.deadly = set(deadly)
        self.dies = False

    def submit(self, function: Callable[[Any], Any], task: Any) -> Any:
        return partial(function, task)

    def wait(self, under_way: Collection[Any]) -> Collection[Any]:
        self.dies = any(self.deadly & set(future.args[0].meshes) for future in under_way)
        return list(under_way)

    def outcome(self, future: Any) -> Any:
        return Killed() if self.dies else future()

    def cancel(self, under_way: Collection[Any]) -> None:
        pass


def tasks(folder: Path) -> list[ShardTask]:
    layout = Layout(tuple(MESHES), 4, 16, per_shard=3)  # six shards of one or two meshes
    ShardedSamples(str(folder), "train", layout).create()
    shards = [layout.shard("train", number) for number in range(layout.shards)]
    return [ShardTask(str(folder), s, recipe(), {name: MESHES[name] for name in s.meshes}) for s in shards]


@pytest.mark.parametrize("deadly", [(), ("b",), ("a", "d")])
def test_only_meshes_that_kill_are_left_out(tmp_path: Path, deadly: tuple[str, ...]) -> None:
    given = tasks(tmp_path)
    done = {task.shard.number: failed for task, failed in render_shards(Unlucky(*deadly), given)}
    assert done == {
        task.shard.number: {mesh: DEADLY for mesh in deadly if mesh in task.shard.meshes} for task in given
    }


def test_if_every_mesh_kills_its_worker_rendering_ends(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="every mesh kills the workers"):
        list(render_shards(Unlucky(*MESHES), tasks(tmp_path)))


def test_a_mesh_that_kills_when_it_is_loaded_is_found_among_bystanders() -> None:
    for deadly in (("c",), ()):
        looked_at = validate_sources(Unlucky(*deadly), list(MESHES.values()))
        found = {task.source.name: why for task, why in looked_at}
        assert found == {name: DEADLY if name in deadly else None for name in MESHES}
