"""Render a data set once, in parallel, on one machine or many; an interrupted rendering continues."""

import warnings
from collections.abc import Collection, Mapping

from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.pool import Pool
from normalgan.data.jobs.request import Sources, lay_out, locate
from normalgan.data.jobs.shard_runner import render_shards
from normalgan.data.jobs.survey import pending_shards
from normalgan.data.jobs.tasks import MakeShard, ShardTask, render_shard
from normalgan.data.jobs.workers import Workers
from normalgan.data.recipe import SampleRecipe
from normalgan.data.store.local_cache import LocalCache
from normalgan.data.store.manifest import Manifest
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError
from normalgan.progress import progress_bar

__all__ = ["Sources", "open_samples", "render_samples"]


def render_samples(
    cache: str,
    sources: Sources,
    views_per_mesh: int | Mapping[str, int],
    recipe: SampleRecipe,
    workers: int = 0,
    progress: bool = True,
    cluster: str | None = None,
    thorough: bool = False,
    per_shard: int = 32,
    later: Collection[str] = (),
) -> dict[str, ShardedSamples]:
    """Render missing and damaged samples, and return the samples of every split.

    The bytes do not depend on the machine or on interruptions. A mesh that cannot be used or rendered is left
    out with a warning that says why. A damaged shard is named in a warning.

    Args:
        cache: folder of all data sets, a path or a URL; this one lies in it under its key.
        sources: the meshes by split.
        views_per_mesh: samples to render of each mesh, one number or one a split.
        recipe: how.
        workers: processes to render in, 0 for this one alone.
        progress: whether to show progress bars on the error stream.
        cluster: a Dask cluster to render on instead; see `Cluster`.
        thorough: whether to check every byte in a distant store too, not only that all objects are there, and
            to try meshes once more that could not be rendered.
        per_shard: samples to a shard, if the data set is new: 32 suit reading in any order, more suit a store
            that counts objects.
        later: splits whose samples are made when they are first read; see `open_samples`. Only the first
            usable shard of each is made now, so that a split without a usable sample is refused at once.

    Raises:
        InputError: if the request makes no sense, a split has no mesh that can be used, the renderer does
            not run here, the folder cannot be written to, the cluster cannot be reached or is of another
            version, or workers die whatever they render. Finished shards are kept.
    """
    if per_shard < 1:
        raise InputError(f"a shard has 1 sample or more, not {per_shard}.")
    folder, views, meshes = locate(cache, sources, views_per_mesh, recipe)
    if (workers > 0 or cluster) and folder.in_memory:
        raise InputError(
            f"{cache} cannot be seen by other processes; set workers to 0 or name another folder."
        )
    folder.sweep()
    if set(views) <= set(later):  # processes would take longer to start than the few samples to make
        workers = 0
    with Cluster(cluster) if cluster else Workers(workers) as pool:
        manifest = Manifest.read(folder)
        if manifest is None:
            if Manifest.damaged(folder):
                warnings.warn(f"damaged, and written again: the manifest of {folder.url}.", stacklevel=2)
            manifest = lay_out(pool, sources, views, recipe, meshes, per_shard)
            manifest.write(folder)
        elif folder.local or thorough:
            manifest.describe(folder)  # mends what describes the arrays
        make = MakeShard(folder.address, recipe, meshes)
        tasks = [
            make.task(shard)
            for split, store in manifest.stores(folder).items()
            if split not in later
            for shard in pending_shards(pool, store, thorough)
        ]
        _render_all(pool, tasks, progress)
        for split in later:
            if split in manifest.splits:
                _make_one(manifest.stores(folder)[split], make)
    stores, reasons = manifest.finished(folder)
    _warn(reasons, recipe.noun)
    return stores


def open_samples(
    cache: str,
    sources: Sources,
    views_per_mesh: int | Mapping[str, int],
    recipe: SampleRecipe,
    local_cache: LocalCache | None = None,
    later: Collection[str] = (),
) -> dict[str, ShardedSamples]:
    """Return the samples that `render_samples` has made for the same request; writes nothing.

    Args:
        cache: as it was given to `render_samples`, as are the next three.
        sources: the meshes by split.
        views_per_mesh: samples of each mesh.
        recipe: how they were made.
        local_cache: where shards of a distant store are kept after their first use; a folder on this machine
            needs none, and gets none.
        later: splits whose missing and damaged samples are made when they are first read. A mesh or pair that
            fails keeps its index there, so the order of the others does not depend on when it failed.

    Raises:
        InputError: if some are missing.
    """
    folder, _, meshes = locate(cache, sources, views_per_mesh, recipe)
    manifest = Manifest.read(folder)
    if manifest is None or any(
        store.missing() for split, store in manifest.stores(folder).items() if split not in later
    ):
        raise InputError(f"not all of these samples are in {folder.url}; render them first.")
    make = MakeShard(folder.address, recipe, meshes)
    lazy = {
        split: ShardedSamples(folder.url, split, layout, (), local_cache, make)
        for split, layout in manifest.splits.items()
        if split in later
    }
    return manifest.finished(folder, local_cache)[0] | lazy


def _make_one(store: ShardedSamples, make: MakeShard) -> None:
    """Make shards of a split until one holds a sample."""
    missing, failures = set(store.missing()), store.failures()
    for number in range(store.layout.shards):
        shard = store.layout.shard(store.split, number)
        if number in missing:
            failures[number] = render_shard(make.task(shard))
        if set(failures.get(number, {})) < set(shard.meshes):
            return


def _warn(left_out: Mapping[str, str], noun: str) -> None:
    for name, reason in left_out.items():
        warnings.warn(f"the {noun} {name} is left out: {reason}", stacklevel=3)


def _render_all(pool: Pool, tasks: list[ShardTask], progress: bool) -> None:
    total = sum(len(task.shard) for task in tasks)
    with progress_bar("rendering", total, "samples", progress) as advance:
        for task, _ in render_shards(pool, tasks):
            advance(len(task.shard))
