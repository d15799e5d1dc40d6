"""Render a data set once, in parallel, on one or many machines, with support for resuming."""

import hashlib
import json
import warnings
from collections.abc import Collection, Mapping, Sequence

from normalgan.data.jobs.cluster import Cluster
from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.tasks import (
    MakeShard,
    MeshTask,
    ShardTask,
    check_recipe,
    find_damage,
    render_shard,
    render_shards,
    validate_sources,
)
from normalgan.data.jobs.workers import Workers
from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.splits import none_usable, plural
from normalgan.data.store.fsspec_storage import ObjectFolder
from normalgan.data.store.manifest import Manifest, dataset_key, fingerprints, views_by_split
from normalgan.data.store.sample_layout import Layout, Shard
from normalgan.data.store.shards import ShardedSamples
from normalgan.errors import InputError, RunError
from normalgan.files.json_files import encode_json
from normalgan.progress import progress_bar
from normalgan.rendering.samples import RENDERING_VERSION

Sources = Mapping[str, Sequence[Loadable]]
_AT_ONCE = 64  # shards checked per task, a few seconds of reading


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
    """Render missing and damaged samples, and return the samples by split.

    >>> from normalgan.animals import Animal
    >>> from normalgan.rendering import EmbreeRenderer, Views
    >>> from normalgan.rendering.lines import SuggestiveContours
    >>> from normalgan.rendering.samples import Recipe
    >>> recipe = Recipe(Views(elevation=(0, 20)), EmbreeRenderer(), SuggestiveContours(), size=64)
    >>> animals = {"train": [Animal("horse", 1)]}
    >>> samples = render_samples("memory://cache", animals, 2, recipe, progress=False)["train"]
    >>> samples.name(0), samples.read(0).normal.shape
    ('horse-0001/0', (64, 64, 3))

    The bytes do not depend on the machine or on interruptions. A mesh that cannot be used or rendered is
    left out with a warning that gives the reason. Damaged shards are reported in a warning.

    Args:
        cache: folder of all data sets, a path or a URL; this data set goes to a subfolder named by its
            key.
        sources: meshes by split.
        views_per_mesh: number of samples per mesh, either one number or one per split.
        recipe: recipe of the samples.
        workers: number of rendering processes; 0 to use only this process.
        progress: whether to show progress bars on stderr.
        cluster: Dask cluster to render on instead; see `Cluster`.
        thorough: whether to check every byte in a remote store too, not only that all objects exist, and to
            retry meshes that could not be rendered.
        per_shard: number of samples per shard, for a new data set. 32 is good for reading in any order;
            use more for a store that limits the number of objects.
        later: splits with samples that are created on first read; see `open_samples`. Only the first
            usable shard of each is created now, to refuse a split without usable samples immediately.

    Raises:
        InputError: if the arguments are invalid, a split has no usable mesh, the renderer does not run
            here, the folder is not writable, the cluster cannot be reached or has other versions, or
            workers die regardless of the mesh. Finished shards are kept.
    """
    if per_shard < 1:
        raise InputError(f"a shard needs at least 1 sample, not {per_shard}.")
    folder, views, meshes = _locate(cache, sources, views_per_mesh, recipe)
    if (workers > 0 or cluster) and folder.in_memory:
        raise InputError(f"{cache} is invisible to other processes; set workers to 0 or name another folder.")
    folder.sweep()
    if set(views) <= set(later):  # starting processes would take longer than rendering the few samples
        workers = 0
    with Cluster(cluster) if cluster else Workers(workers) as pool:
        manifest = Manifest.read(folder)
        if manifest is None:
            if Manifest.damaged(folder):
                warnings.warn(f"damaged, and written again: the manifest of {folder.url}.", stacklevel=2)
            manifest = _lay_out(pool, sources, views, recipe, meshes, per_shard)
            manifest.write(folder)
        elif folder.local or thorough:
            manifest.describe(folder)  # repairs the arrays' metadata
        make = MakeShard(folder.address, recipe, meshes)
        tasks = [
            make.task(shard)
            for split, store in manifest.stores(folder).items()
            if split not in later
            for shard in _pending_shards(pool, store, thorough)
        ]
        _render_all(pool, tasks, progress)
        for split in later:
            if split in manifest.splits:
                _make_one(manifest.stores(folder)[split], make)
    stores, reasons = manifest.finished(folder, recipe.noun)
    _warn(reasons, recipe.noun)
    return stores


def open_samples(
    cache: str,
    sources: Sources,
    views_per_mesh: int | Mapping[str, int],
    recipe: SampleRecipe,
    later: Collection[str] = (),
) -> dict[str, ShardedSamples]:
    """Return the samples that `render_samples` created for the same arguments, without writing anything.

    Args:
        cache: folder of all data sets, as for `render_samples`.
        sources: meshes by split.
        views_per_mesh: number of samples per mesh.
        recipe: recipe of the samples.
        later: splits with missing and damaged samples that are created on first read. A mesh or pair that
            fails keeps its index there, so the order of the others does not depend on when it failed.

    Raises:
        InputError: if samples are missing.
    """
    folder, _, meshes = _locate(cache, sources, views_per_mesh, recipe)
    manifest = Manifest.read(folder)
    if manifest is None or any(
        store.missing() for split, store in manifest.stores(folder).items() if split not in later
    ):
        raise InputError(f"not all of these samples are in {folder.url}; render them first.")
    make = MakeShard(folder.address, recipe, meshes)
    lazy = {
        split: ShardedSamples(folder.url, split, layout, (), make)
        for split, layout in manifest.splits.items()
        if split in later
    }
    return manifest.finished(folder, recipe.noun)[0] | lazy


def _make_one(store: ShardedSamples, make: MakeShard) -> None:
    """Create shards of a split until one holds a usable sample."""
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


def find_unusable(cache: str, sources: Sequence[Loadable], workers: int = 0) -> dict[str, str]:
    """Return the reasons why meshes cannot be used, by name.

    Each mesh must be loaded, which takes up to a second, so the result is cached in ``meshes/<key>.json``
    under a hash of the fingerprints, for resumed runs and all training processes.

    Args:
        cache: folder or URL of all data sets.
        sources: meshes to check.
        workers: number of loading processes; 0 to use only this process.

    Raises:
        InputError: if the cache is not writable, or a worker is killed.
    """
    prints = fingerprints({"": sources})[""]
    key = hashlib.sha256(json.dumps([RENDERING_VERSION, prints]).encode())
    path = f"{key.hexdigest()[:24]}.json"
    folder = ObjectFolder(cache) / "meshes"
    try:
        return dict(json.loads(folder.read(path) or b"")["left_out"])
    except (ValueError, TypeError, KeyError):  # not cached yet, or damaged
        pass
    with Workers(workers) as pool:
        tasks = [MeshTask(source, seen) for source, (_, seen) in zip(sources, prints, strict=True)]
        reasons = {}
        with progress_bar("looking at", len(tasks), "meshes", stays=False) as advance:
            for task, reason in validate_sources(pool, tasks):
                advance(1)
                if reason is not None:
                    reasons[task.source.name] = reason
    left_out = {source.name: reasons[source.name] for source in sources if source.name in reasons}
    folder.write(path, encode_json({"left_out": left_out}))
    return left_out


def leave_out(
    sources: Sequence[Loadable], reasons: Mapping[str, str], split: str, noun: str
) -> list[Loadable]:
    """Return the usable meshes.

    Args:
        sources: all meshes.
        reasons: reasons why meshes cannot be used, by name.
        split: name of the split.
        noun: word for a mesh in messages.

    Raises:
        InputError: if there is no usable mesh.
    """
    if not sources:
        raise InputError(f"there are no {plural(noun)} for {split}; give at least one.")
    usable = [source for source in sources if source.name not in reasons]
    if not usable:
        raise none_usable(len(sources), noun, split, reasons[sources[0].name])
    return usable


def _locate(
    cache: str, sources: Sources, views_per_mesh: int | Mapping[str, int], recipe: SampleRecipe
) -> tuple[ObjectFolder, dict[str, int], dict[str, MeshTask]]:
    """Return the folder of the data set, the number of views by split, and the meshes by name.

    Raises:
        InputError: if the arguments are invalid.
    """
    views = views_by_split(views_per_mesh, sources, recipe.noun)
    prints = fingerprints({split: sources[split] for split in views})
    folder = ObjectFolder(cache) / dataset_key(prints, views, recipe)
    known = dict(pair for part in prints.values() for pair in part)
    return folder, views, {s.name: MeshTask(s, known[s.name]) for split in views for s in sources[split]}


def _lay_out(
    pool: Pool,
    sources: Sources,
    views: Mapping[str, int],
    recipe: SampleRecipe,
    meshes: Mapping[str, MeshTask],
    per_shard: int,
) -> Manifest:
    """Return the layout of a new data set, after loading one mesh of each split.

    It loads meshes of each split until one is usable, to refuse a split without usable meshes before hours
    of rendering. The other meshes are loaded, and may fail, when they are rendered.

    Raises:
        InputError: if the renderer does not run, or a split has no usable mesh.
    """
    for _, outcome in pool.run(check_recipe, [recipe]):
        if isinstance(outcome, Killed):
            raise RunError(f"{type(recipe).__name__} kills the process that checks whether it can run.")
    splits = {}
    for split, number in views.items():
        names = tuple(source.name for source in sources[split])
        _refuse_if_none_usable(pool, [meshes[name] for name in names], split, recipe.noun)
        splits[split] = Layout(names, number, recipe.size, per_shard, recipe.hints)
    return Manifest(recipe.describe(), splits)


def _refuse_if_none_usable(pool: Pool, tasks: Sequence[MeshTask], split: str, noun: str) -> None:
    first = ""
    for task in tasks:
        ((_, reason),) = validate_sources(pool, [task])
        if reason is None:
            return
        first = first or reason
    raise none_usable(len(tasks), noun, split, first)


def _pending_shards(pool: Pool, store: ShardedSamples, thorough: bool) -> list[Shard]:
    """Return missing and damaged shards, and warn about the damaged ones.

    Args:
        pool: pool that runs the checks, if there are many machines.
        store: samples of a split.
        thorough: whether to check every byte of a remote store too, and to retry failed meshes.
    """
    storage = ObjectFolder(store.url)
    missing = store.missing()
    if isinstance(pool, Cluster) and (storage.local or thorough):
        damaged = _check_side_by_side(pool, storage.address, store)
    else:
        # A remote store has its own checksums, and reading all of it for each run would take hours.
        damaged = store.verify() if storage.local or thorough else store.lost()
    damaged = sorted({*damaged, *store.unexplained()})
    if damaged:
        numbers = ", ".join(map(str, damaged))
        warnings.warn(
            f"damaged, and rendered again: shard {numbers} of {store.split} in {store.url}.", stacklevel=3
        )
    again = set(store.failures()) if thorough else set()
    return [store.layout.shard(store.split, number) for number in sorted({*missing, *damaged, *again})]


def _check_side_by_side(pool: Pool, url: str, store: ShardedSamples) -> list[int]:
    finished, damaged = store.finished(), list[int]()
    parts = [finished[start : start + _AT_ONCE] for start in range(0, len(finished), _AT_ONCE)]
    for _, found in pool.run(find_damage, [(url, store.split, part) for part in parts]):
        if isinstance(found, Killed):
            raise RunError("the workers are killed while they check what is finished: give them more memory.")
        damaged += found
    return sorted(damaged)
