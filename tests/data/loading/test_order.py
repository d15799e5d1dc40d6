from collections import Counter, OrderedDict
from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np
import pytest

from normalgan.data.dataset import SampleDataset
from normalgan.data.loading.loaders import Loaders
from normalgan.data.loading.order import (
    ABREAST,
    BATCHES_PER_CYCLE,
    VIEWS_AT_ONCE,
    ShardOrder,
    ViewIndex,
    order_of_epoch,
    spread,
)
from normalgan.data.store.sample_layout import Layout
from normalgan.data.store.shards import ShardedSamples


def batches(order: Iterable[ViewIndex], size: int) -> Iterator[list[ViewIndex]]:
    tickets = list(order)
    yield from (tickets[i : i + size] for i in range(0, len(tickets), size))


def loads(order: Iterable[ViewIndex], size: int, workers: int, room: int) -> int:
    """Return how often meshes are loaded by workers that take turns and keep the meshes used last."""
    caches: list[OrderedDict[int, None]] = [OrderedDict() for _ in range(workers)]
    count = 0
    for number, batch in enumerate(batches(order, size)):
        cached = caches[number % workers]
        for ticket in batch:
            count += ticket.mesh not in cached
            cached[ticket.mesh] = None
            cached.move_to_end(ticket.mesh)
            if len(cached) > room:
                cached.popitem(last=False)
    return count


@pytest.mark.parametrize(("meshes", "views"), [(1, 1), (3, 7), (5, 16), (4, 17), (300, 40)])
@pytest.mark.parametrize("epoch", [0, 2])
def test_every_view_of_the_epoch_comes_once(meshes: int, views: int, epoch: int) -> None:
    order = list(order_of_epoch(meshes, views, epoch, seed=0, batch_size=8))
    assert len(order) == meshes * views
    assert set(order) == {ViewIndex(m, epoch * views + v) for m in range(meshes) for v in range(views)}


def test_order_depends_on_seed_and_epoch_alone() -> None:
    def meshes(seed: int, epoch: int) -> list[int]:
        np.random.seed(seed + 5)  # noqa: NPY002 -- global state must not matter
        return [ticket.mesh for ticket in order_of_epoch(50, 10, epoch, seed, batch_size=4)]

    assert meshes(0, 0) == meshes(0, 0)
    assert meshes(0, 0) != meshes(1, 0)
    assert meshes(0, 0) != meshes(0, 1)


def test_a_batch_shows_as_many_meshes_as_samples_and_the_next_one_others() -> None:
    shown = [
        {t.mesh for t in batch}
        for batch in batches(order_of_epoch(1000, VIEWS_AT_ONCE, 0, 0, batch_size=8), 8)
    ]
    assert all(len(batch) == 8 for batch in shown)
    assert not any(a & b for a, b in pairwise(shown))


@pytest.mark.parametrize("workers", [1, 3, 8])
@pytest.mark.parametrize("batch", [8, 5])
def test_a_mesh_is_loaded_once_for_a_group_of_views(workers: int, batch: int) -> None:
    meshes, views, row = 1000, 40, BATCHES_PER_CYCLE * batch  # three groups of a mesh; caches hold a row
    count = loads(order_of_epoch(meshes, views, 0, 0, batch), batch, workers, room=row)
    # The last groups of an epoch need not fill a row; their batches then come to all workers.
    assert count <= meshes * 3 + row * (workers - 1)
    shuffled = [
        ViewIndex(int(i) // views, int(i) % views) for i in np.random.default_rng(0).permutation(40_000)
    ]
    assert loads(shuffled, batch, workers, room=row) > 5 * count


def test_other_numbers_of_workers_cost_loads_but_no_more_than_that() -> None:
    order = list(order_of_epoch(1000, 32, 0, 0, batch_size=8))
    assert loads(order, 8, 5, room=BATCHES_PER_CYCLE * 8) <= 1000 * 2 * 5


def test_meshes_are_spread_over_an_epoch_of_many_windows() -> None:
    size = 2000
    order = [ticket.mesh for ticket in order_of_epoch(40, 1000, 0, 0, batch_size=4)]
    for start in range(0, len(order), size):
        counts = Counter(order[start : start + size])
        assert len(counts) >= 25  # of 40 meshes; a window holds 96 groups
        assert max(counts.values()) < size / 5


@pytest.mark.parametrize("total", [1, 2, 5, 7, 100])
@pytest.mark.parametrize("count", [1, 2, 4, 6])
def test_spread_is_even_and_within(total: int, count: int) -> None:
    chosen = spread(total, count)
    assert len(chosen) == len(set(chosen)) == min(total, count)
    assert chosen[0] == 0
    if count > 1:
        assert chosen[-1] == total - 1
    steps = np.diff(chosen)
    assert not len(steps) or steps.max() - steps.min() <= 1


MESHES = tuple(f"mesh {number}" for number in range(300))
STORE = ShardedSamples("memory://nothing", "train", Layout(MESHES, 13, 16))  # 3900 samples in 122 shards
HOLED = ShardedSamples("memory://nothing", "train", STORE.layout, MESHES[5:17])


def shard_order(store: ShardedSamples, replicas: int = 1, rank: int = 0, epoch: int = 0) -> list[int]:
    sampler = ShardOrder(store, replicas, rank, seed=3)
    sampler.set_epoch(epoch)
    drawn = list(sampler)
    assert len(drawn) == len(sampler)
    return drawn


@pytest.mark.parametrize("store", [STORE, HOLED])
def test_every_sample_is_seen_once_an_epoch_in_another_order(store: ShardedSamples) -> None:
    first, again, second = shard_order(store), shard_order(store), shard_order(store, epoch=1)
    assert sorted(first) == sorted(second) == list(range(len(store)))
    assert first == again != second


def test_a_shard_is_done_with_before_many_others_begin() -> None:
    drawn = shard_order(STORE)
    shards = [index // 32 for index in drawn]
    window = 32 * ABREAST
    assert len(set(shards[: window - 40])) == ABREAST
    assert not set(shards[: window - 40]) & set(shards[window:])
    assert max(Counter(shards[:32]).values()) < 8  # and yet well mixed: a batch is not one shard


@pytest.mark.parametrize("replicas", [2, 3, 7])
def test_processes_share_the_shards_out(replicas: int) -> None:
    shares = [shard_order(STORE, replicas, rank) for rank in range(replicas)]
    assert len({len(share) for share in shares}) == 1
    seen = Counter(index for share in shares for index in share)
    assert len(seen) > 0.97 * len(STORE)
    assert max(seen.values()) <= 2
    for rank, share in enumerate(shares):
        others = {i // 32 for other in shares[:rank] + shares[rank + 1 :] for i in other}
        assert len({i // 32 for i in share} & others) <= replicas


def test_a_loader_uses_it_for_a_distant_store_that_is_not_held() -> None:
    far = Loaders(4, 0).shuffled(SampleDataset(STORE, memory=0), seed=1)
    assert isinstance(far.sampler, ShardOrder)
