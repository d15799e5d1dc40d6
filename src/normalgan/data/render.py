"""Rendering a data set to disk: once, side by side, going on where it was interrupted."""

import warnings
from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from normalgan.data.layout import Layout
from normalgan.data.manifest import Manifest, dataset_key, fingerprints, views_by_split
from normalgan.data.shards import ShardedSamples
from normalgan.data.storage import Storage
from normalgan.data.tasks import ShardTask, check_renderer, find_trouble, render_shard
from normalgan.data.workers import Workers
from normalgan.errors import InputError
from normalgan.rendering.mesh import MeshSource
from normalgan.rendering.samples import Recipe

Sources = Mapping[str, Sequence[MeshSource]]


def render_samples(
    cache: str,
    sources: Sources,
    views_per_mesh: int | Mapping[str, int],
    recipe: Recipe,
    workers: int = 0,
    progress: bool = True,
) -> dict[str, ShardedSamples]:
    """Return the samples of every split, after rendering those that are not there or are damaged.

    The bytes are the same whatever the number of workers and however often it was interrupted. A mesh
    that cannot be used is left out, with a warning that says why; a damaged shard is named in a warning.

    Args:
        cache: folder of all data sets, a path or a URL; this one lies in it under its key.
        sources: the meshes by split.
        views_per_mesh: samples to render of each mesh, one number or one a split.
        recipe: how.
        workers: processes to render in, 0 for this one alone.
        progress: whether to show a progress bar on the error stream.

    Raises:
        InputError: if the request makes no sense, a split has no mesh that can be used, the renderer does
            not run here, the folder cannot be written to, or a worker is killed. Finished shards are kept.
    """
    folder, views, prints = _locate(cache, sources, views_per_mesh, recipe)
    if workers > 0 and folder.in_memory:
        raise InputError(
            f"{cache} cannot be seen by other processes; set workers to 0 or name another folder."
        )
    folder.sweep()
    with Workers(workers) as pool:
        manifest = Manifest.read(folder)
        if manifest is None:
            manifest = _lay_out(pool, sources, views, recipe)
            manifest.write(folder)
        _warn_of_left_out(manifest)
        stores = manifest.stores(folder)
        known = {s.name: (s, prints[s.name]) for part in sources.values() for s in part}
        tasks = [
            ShardTask(store, shard, recipe, {name: known[name] for name in store.meshes(shard)})
            for store in stores.values()
            for shard in _outstanding(store)
        ]
        _render_all(pool, tasks, progress)
    return stores


def open_samples(
    cache: str, sources: Sources, views_per_mesh: int | Mapping[str, int], recipe: Recipe
) -> dict[str, ShardedSamples]:
    """Return the samples that `render_samples` has made of the same request; writes nothing.

    Raises:
        InputError: if they are not there, or not all of them.
    """
    folder, _, _ = _locate(cache, sources, views_per_mesh, recipe)
    manifest = Manifest.read(folder)
    stores = manifest.stores(folder) if manifest else {}
    if not stores or any(store.missing() for store in stores.values()):
        raise InputError(f"not all of these samples are in {folder.url}; render them first.")
    return stores


def _lay_out(pool: Workers, sources: Sources, views: Mapping[str, int], recipe: Recipe) -> Manifest:
    """Find out which meshes can be used; loading is all that can tell."""
    for _ in pool.run(check_renderer, [recipe.renderer]):
        pass
    every = [source for part in sources.values() for source in part]
    reasons = {source.name: reason for source, reason in pool.run(find_trouble, every) if reason is not None}
    left_out = {source.name: reasons[source.name] for source in every if source.name in reasons}
    splits = {}
    for split, number in views.items():
        usable = tuple(source.name for source in sources[split] if source.name not in left_out)
        if not usable:
            first = left_out[sources[split][0].name]
            raise InputError(
                f"none of the {len(sources[split])} meshes for {split} can be used; the first: {first}"
            )
        splits[split] = Layout(usable, number, recipe.size)
    return Manifest(recipe.describe(), splits, left_out)


def _locate(
    cache: str, sources: Sources, views_per_mesh: int | Mapping[str, int], recipe: Recipe
) -> tuple[Storage, dict[str, int], dict[str, str]]:
    """Return the folder of the data set, the views by split and the fingerprints by mesh."""
    views = views_by_split(views_per_mesh, sources)
    prints = fingerprints({split: sources[split] for split in views})
    folder = Storage(cache) / dataset_key(prints, views, recipe)
    return folder, views, dict(pair for part in prints.values() for pair in part)


def _outstanding(store: ShardedSamples) -> list[int]:
    damaged = store.verify()
    if damaged:
        numbers = ", ".join(map(str, damaged))
        warnings.warn(
            f"damaged, and rendered again: shard {numbers} of {store.split} in {store.url}.", stacklevel=3
        )
    return sorted(store.missing() + damaged)


def _warn_of_left_out(manifest: Manifest) -> None:
    for name, reason in manifest.left_out.items():
        warnings.warn(f"the mesh {name} is left out: {reason}", stacklevel=3)


def _render_all(pool: Workers, tasks: list[ShardTask], progress: bool) -> None:
    columns = (
        TextColumn("rendering"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("samples"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), disable=not (progress and tasks)) as bar:
        sizes = [len(task.store.layout.indices(task.number)) for task in tasks]
        meter = bar.add_task("", total=sum(sizes))
        for task, _ in pool.run(render_shard, tasks):
            bar.advance(meter, len(task.store.layout.indices(task.number)))
