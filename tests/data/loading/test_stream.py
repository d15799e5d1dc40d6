import multiprocessing
import os
import pickle
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import psutil
import pytest
import torch
from toys import BallRenderer, Counted, Octahedron, recipe

from normalgan.batch import Batch
from normalgan.data.dataset import SampleDataset
from normalgan.data.loading.items import Item, SampleError
from normalgan.data.loading.loaders import Loaders
from normalgan.data.loading.order import ViewIndex
from normalgan.data.loading.stream import FreshViews, MeshCache, StreamDataset
from normalgan.data.render import render_samples
from normalgan.errors import InputError
from normalgan.rendering.cameras import Camera, Views
from normalgan.rendering.lines.base import LineDrawing
from normalgan.rendering.maps import Maps
from normalgan.rendering.mesh import Mesh
from normalgan.rendering.samples import Recipe
from normalgan.rendering.strokes import Stroke
from normalgan.rendering.view import View

# Torch's loader asks for this; the machine that tests may have one core and warn of two workers.
pytestmark = pytest.mark.filterwarnings("ignore:This DataLoader will create:UserWarning")

SOURCES = [Octahedron("a"), Octahedron("b", 0.2), Octahedron("c", 0.8)]


@dataclass(frozen=True)
class Confiding(BallRenderer):
    """Fails, and says where it is."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        spawned = multiprocessing.parent_process() is not None and os.environ["OMP_NUM_THREADS"] == "1"
        raise InputError(f"spawned {spawned}, threads {torch.get_num_threads()}.")


@dataclass(frozen=True)
class Careless(BallRenderer):
    """Has a bug."""

    def render(self, mesh: Mesh, camera: Camera, size: int) -> Maps:
        raise ZeroDivisionError("division by zero")


@dataclass(frozen=True)
class Cross(LineDrawing):
    """Takes no time."""

    def trace(self, view: View, rng: np.random.Generator) -> list[Stroke]:
        return [Stroke.even(np.array([[0.0, 0.0], [view.size, view.size]]), 1.0)]


def stream(views: int = 4, memory: int = 10**6) -> StreamDataset:
    return StreamDataset(SOURCES, views, recipe(), memory)


def assert_same(a: Item | Batch, b: Item | Batch) -> None:
    assert a["name"] == b["name"]
    for name in ("sketch", "normal", "mask"):
        assert torch.equal(a[name], b[name]), name


def test_the_first_epoch_is_what_shards_would_hold(tmp_path: Path) -> None:
    stored = SampleDataset(
        render_samples(str(tmp_path), {"train": SOURCES}, 4, recipe(), progress=False)["train"]
    )
    rendered = stream(views=4)
    assert len(rendered) == len(stored) == 12
    for index in (*range(12), -1):
        assert_same(rendered[index], stored[index])
    with pytest.raises(IndexError):
        rendered[12]


def test_a_sample_depends_only_on_its_view_index() -> None:
    first, second = stream(), stream(memory=0)
    ticket = ViewIndex(1, 1001)
    wanted = first[ticket]
    assert wanted["name"] == "b/1001"
    for other in (ViewIndex(0, 3), ViewIndex(2, 7), ViewIndex(1, 1000)):
        assert not torch.equal(second[other]["normal"], wanted["normal"])
    assert_same(second[ticket], wanted)


@pytest.mark.slow  # processes are spawned
def test_batches_are_the_same_whatever_the_number_of_workers() -> None:
    epochs: dict[int, list[list[Batch]]] = {}
    for workers in (0, 2):
        loader = Loaders(batch_size=2, workers=workers).shuffled(stream(views=3), seed=5)
        assert isinstance(loader.sampler, FreshViews)
        epochs[workers] = []
        for epoch in (0, 1):  # the workers persist, and see the epoch by the tickets
            loader.sampler.set_epoch(epoch)
            epochs[workers].append(list(loader))
    for given, expected in zip(epochs[2], epochs[0], strict=True):
        assert len(given) == 4  # the ninth sample is left out
        for a, b in zip(given, expected, strict=True):
            assert_same(a, b)
    names = [{name for batch in epoch for name in batch["name"]} for epoch in epochs[0]]
    assert not names[0] & names[1]


@pytest.mark.slow  # a process is spawned
def test_workers_are_spawned_with_a_thread_each_and_their_errors_are_a_sentence() -> None:
    failing = StreamDataset(SOURCES[:1], 4, Recipe(recipe().views, Confiding(), recipe().lines, 16), 0)
    loader = Loaders(batch_size=4, workers=1).chosen(failing, [2, 3])
    before = os.environ.copy()
    with pytest.raises(InputError) as caught:
        next(iter(loader))
    assert str(caught.value) == "view 2 of a cannot be rendered: spawned True, threads 1."
    assert os.environ == before


def test_errors_name_the_mesh_and_keep_the_reason() -> None:
    flawed = StreamDataset([Octahedron("x", flaw="is torn")], 1, recipe(), 0)
    with pytest.raises(SampleError, match=r"^view 0 of x cannot be rendered: x is torn\.$"):
        flawed[0]


def test_a_bug_of_a_renderer_is_told_with_its_place() -> None:
    flawed = StreamDataset(SOURCES[:1], 1, replace(recipe(), renderer=Careless()), 0)
    with pytest.raises(
        SampleError, match=r"rendered: ZeroDivisionError: .*, in Careless.render, test_stream.py line \d+\.$"
    ):
        flawed[0]


@pytest.mark.slow
def test_memory_stays_flat() -> None:
    sources = [Octahedron(f"m{i}", 0.2 + i / 100) for i in range(30)]
    making = Recipe(Views(), BallRenderer(), Cross(), size=64)
    rendered = StreamDataset(sources, 10, making, memory=1000)  # room for four meshes
    sampler = FreshViews(rendered, seed=0, batch_size=1)
    taken = []
    for epoch in (0, 1):
        sampler.set_epoch(epoch)
        for ticket in sampler:
            rendered[ticket]
        taken.append(psutil.Process().memory_info().rss)
    assert len(rendered.mesh_cache) == 4
    assert taken[1] - taken[0] < 4 * 2**20  # 300 samples would take 24


@pytest.mark.parametrize("replicas", [1, 2, 3])
@pytest.mark.parametrize("batch_size", [1, 2, 5])
def test_processes_share_an_epoch(replicas: int, batch_size: int) -> None:
    rendered = stream(views=17)
    shares = [list(FreshViews(rendered, 0, batch_size, replicas, rank)) for rank in range(replicas)]
    lengths = {len(FreshViews(rendered, 0, batch_size, replicas, rank)) for rank in range(replicas)}
    assert {len(share) for share in shares} == lengths
    assert lengths == {51 // (batch_size * replicas) * batch_size}
    together = [ticket for share in shares for ticket in share]
    assert len(set(together)) == len(together)


def test_too_few_samples_for_a_batch_each_are_all_dealt_out() -> None:
    rendered = stream(views=2)
    shares = [list(FreshViews(rendered, 0, batch_size=4, replicas=4, rank=rank)) for rank in range(4)]
    assert [len(share) for share in shares] == [2, 2, 2, 2]
    assert len({ticket for share in shares for ticket in share}) == 6
    (batch,) = Loaders(batch_size=50, workers=0).shuffled(rendered, seed=0)
    assert len(batch["name"]) == 6


BYTES = 6 * 12 + 8 * 12 + 6 * 12
"""An octahedron's: vertices, faces, normals."""


def cached(count: int, limit: int) -> tuple[MeshCache, list[str]]:
    loads: list[str] = []
    return MeshCache([Counted(str(i), loads) for i in range(count)], limit), loads


def test_the_most_recently_used_meshes_are_kept() -> None:
    meshes, loads = cached(4, limit=2 * BYTES)
    for number in (0, 1, 0, 2, 0, 1):
        assert meshes.take(number).name == str(number)
    assert loads == ["0", "1", "2", "1"]


@pytest.mark.parametrize(("limit", "kept"), [(0, 1), (BYTES - 1, 1), (3 * BYTES + 1, 3), (100 * BYTES, 7)])
def test_the_bound_is_kept(limit: int, kept: int) -> None:
    meshes, _ = cached(7, limit)
    for number in range(7):
        meshes.take(number)
        assert meshes.bytes == BYTES * len(meshes) <= max(limit, BYTES)
    assert len(meshes) == kept


def test_a_worker_starts_with_an_empty_cache() -> None:
    meshes = MeshCache([Octahedron("a")], limit=10 * BYTES)
    meshes.take(0)
    handed = pickle.loads(pickle.dumps(meshes))
    assert (len(handed), handed.bytes, len(meshes)) == (0, 0, 1)
    assert handed.take(0).name == "a"


def test_an_invalid_mesh_is_refused_before_it_is_cached() -> None:
    class Empty(Octahedron):
        def load(self) -> Mesh:
            return None  # type: ignore[return-value]

    meshes = MeshCache([Empty("a")], limit=BYTES)
    with pytest.raises(InputError, match="its load gave NoneType"):
        meshes.take(0)
    assert len(meshes) == meshes.bytes == 0
