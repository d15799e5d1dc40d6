"""Files of meshes that are replaced while they are rendered: no sample of one is stored for another."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from toys import contents, recipe

from normalgan.data.jobs import tasks
from normalgan.data.jobs.tasks import ChangedMeshError, MeshTask, ShardTask, render_shard
from normalgan.data.render import render_samples
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.mesh_files import MeshFile

SOLID = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 {} 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


@dataclass(frozen=True)
class Replaced(MeshFile):
    """A file that somebody replaces between the fingerprint and the mesh."""

    def load(self) -> Mesh:
        Path(self.path).write_text(SOLID.format(3))
        return super().load()


def solid(folder: Path, height: float) -> str:
    folder.mkdir(exist_ok=True)
    (folder / "solid.off").write_text(SOLID.format(height))
    return str(folder / "solid.off")


def test_a_file_replaced_while_it_is_loaded_is_rendered_as_it_was_fingerprinted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = solid(tmp_path / "meshes", 1)
    render_samples(str(tmp_path / "plain"), {"train": [MeshFile(path)]}, 3, recipe(), progress=False)
    path = solid(tmp_path / "other", 1)
    monkeypatch.setattr(tasks, "_last", None)  # else the mesh of before is used again
    render_samples(str(tmp_path / "raced"), {"train": [Replaced(path)]}, 3, recipe(), progress=False)
    assert Path(path).read_text() == SOLID.format(3)
    assert contents(tmp_path / "raced") == contents(tmp_path / "plain")


def test_a_file_replaced_after_rendering_began_stops_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = MeshFile(solid(tmp_path / "meshes", 1))
    cache = str(tmp_path / "cache")
    ShardedSamples(cache, "train", Layout(("solid",), 2, 16)).create()
    shard = Layout(("solid",), 2, 16).shard("train", 0)
    task = ShardTask(cache, shard, recipe(), {"solid": MeshTask(source, source.fingerprint())})
    monkeypatch.setattr(tasks, "_last", None)
    for height in (2, None):
        if height is None:
            Path(source.path).unlink()
        else:
            solid(tmp_path / "meshes", height)
        with pytest.raises(ChangedMeshError, match=r"^solid on \S+ has changed since rendering began"):
            render_shard(task)
        assert not list((tmp_path / "cache").glob("done/*/*"))
    solid(tmp_path / "meshes", 1)
    assert render_shard(task) == {}
    assert ShardedSamples(cache, "train", Layout(("solid",), 2, 16)).read(0).mask.any()


def test_the_loaded_mesh_is_that_of_the_bytes(tmp_path: Path) -> None:
    # Else the two tests above would prove nothing.
    one, other = (MeshFile(solid(tmp_path, height)).load() for height in (1, 3))
    assert not np.array_equal(one.vertices, other.vertices)
