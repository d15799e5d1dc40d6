"""Survey: find the shards of a data set that must still be rendered."""

import warnings

from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.tasks import CheckTask, find_damage
from normalgan.data.store.layout import Shard
from normalgan.data.store.shards import ShardedSamples
from normalgan.data.store.storage import Storage
from normalgan.errors import RunError

__all__ = ["pending_shards"]

_AT_ONCE = 64  # shards a task: a few seconds of reading


def pending_shards(pool: Pool, store: ShardedSamples, thorough: bool) -> list[Shard]:
    """Return missing and damaged shards, with a warning that names the damaged ones.

    Args:
        pool: who checks, if there are many machines.
        store: the samples of a split.
        thorough: whether every byte of a distant store is checked too, and failed meshes are tried again.
    """
    storage = Storage(store.url)
    missing = store.missing()
    if isinstance(pool, Cluster) and (storage.local or thorough):
        damaged = _check_side_by_side(pool, storage, store, set(missing))
    else:
        # A distant store keeps sums of its own, and to read all of it for each run would take hours.
        damaged = store.verify() if storage.local or thorough else store.lost()
    damaged = sorted({*damaged, *store.unexplained()})
    if damaged:
        numbers = ", ".join(map(str, damaged))
        warnings.warn(
            f"damaged, and rendered again: shard {numbers} of {store.split} in {store.url}.", stacklevel=3
        )
    again = set(store.failures()) if thorough else set()
    return [store.layout.shard(store.split, number) for number in sorted({*missing, *damaged, *again})]


def _check_side_by_side(pool: Pool, storage: Storage, store: ShardedSamples, missing: set[int]) -> list[int]:
    finished = [number for number in range(store.layout.shards) if number not in missing]
    parts = [tuple(finished[start : start + _AT_ONCE]) for start in range(0, len(finished), _AT_ONCE)]
    damaged: list[int] = []
    tasks = [CheckTask(storage.address, store.split, part) for part in parts]
    for _, found in pool.run(find_damage, tasks):
        if isinstance(found, Killed):
            raise RunError("the workers are killed while they check what is finished: give them more memory.")
        damaged += found
    return sorted(damaged)
