"""A request for samples: their folder, and the layout of a new data set."""

from collections.abc import Mapping, Sequence

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.shard_runner import validate_sources
from normalgan.data.jobs.tasks import MeshTask, check_recipe
from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.splits import plural
from normalgan.data.store.layout import Layout
from normalgan.data.store.manifest import Manifest, dataset_key, fingerprints, views_by_split
from normalgan.data.store.storage import Storage
from normalgan.errors import InputError, RunError

__all__ = ["Sources", "lay_out", "locate"]

Sources = Mapping[str, Sequence[Loadable]]


def locate(
    cache: str, sources: Sources, views_per_mesh: int | Mapping[str, int], recipe: SampleRecipe
) -> tuple[Storage, dict[str, int], dict[str, MeshTask]]:
    """Return the folder of the data set, the views by split, and the meshes by name.

    Raises:
        InputError: if the request makes no sense.
    """
    views = views_by_split(views_per_mesh, sources, recipe.noun)
    prints = fingerprints({split: sources[split] for split in views})
    folder = Storage(cache) / dataset_key(prints, views, recipe)
    known = dict(pair for part in prints.values() for pair in part)
    return folder, views, {s.name: MeshTask(s, known[s.name]) for split in views for s in sources[split]}


def lay_out(
    pool: Pool,
    sources: Sources,
    views: Mapping[str, int],
    recipe: SampleRecipe,
    meshes: Mapping[str, MeshTask],
    per_shard: int,
) -> Manifest:
    """Return the layout of a new data set, after loading one mesh of each split.

    Loads meshes of each split until one can be used, so that a split without any is refused before hours of
    rendering. The others are loaded when they are rendered, and fail there.

    Raises:
        InputError: if the renderer does not run, or no mesh of a split can be used.
    """
    for _, outcome in pool.run(check_recipe, [recipe]):
        if isinstance(outcome, Killed):
            raise RunError(f"{type(recipe).__name__} kills the process that asks whether it runs.")
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
    raise InputError(f"none of the {len(tasks)} {plural(noun)} for {split} can be used; the first: {first}")
