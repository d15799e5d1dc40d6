from collections import Counter

import pytest

from normalgan.data.dataset import SampleDataset
from normalgan.data.loading.loaders import Loaders
from normalgan.data.loading.shard_order import ABREAST, ShardOrder
from normalgan.data.store.layout import Layout
from normalgan.data.store.shards import ShardedSamples

MESHES = tuple(f"mesh {number}" for number in range(300))
STORE = ShardedSamples("memory://nothing", "train", Layout(MESHES, 13, 16))  # 3900 samples in 122 shards
HOLED = ShardedSamples("memory://nothing", "train", STORE.layout, MESHES[5:17])


def order(store: ShardedSamples, replicas: int = 1, rank: int = 0, epoch: int = 0) -> list[int]:
    sampler = ShardOrder(store, replicas, rank, seed=3)
    sampler.set_epoch(epoch)
    drawn = list(sampler)
    assert len(drawn) == len(sampler)
    return drawn


@pytest.mark.parametrize("store", [STORE, HOLED])
def test_every_sample_is_seen_once_an_epoch_in_another_order(store: ShardedSamples) -> None:
    first, again, second = order(store), order(store), order(store, epoch=1)
    assert sorted(first) == sorted(second) == list(range(len(store)))
    assert first == again != second


def test_a_shard_is_done_with_before_many_others_begin() -> None:
    drawn = order(STORE)
    shards = [index // 32 for index in drawn]
    window = 32 * ABREAST
    assert len(set(shards[: window - 40])) == ABREAST
    assert not set(shards[: window - 40]) & set(shards[window:])
    assert max(Counter(shards[:32]).values()) < 8  # and yet well mixed: a batch is not one shard


@pytest.mark.parametrize("replicas", [2, 3, 7])
def test_processes_share_the_shards_out(replicas: int) -> None:
    shares = [order(STORE, replicas, rank) for rank in range(replicas)]
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
