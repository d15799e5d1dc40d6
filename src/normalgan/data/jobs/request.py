"""A request for samples: where they lie, and which of the meshes asked for can be used."""

from collections.abc import Mapping, Sequence

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.tasks import MeshTask, check_recipe
from normalgan.data.jobs.usable import find_troubles
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
    progress: bool,
) -> Manifest:
    """Find out which meshes can be used, as only loading them can tell, and say what lies where.

    ``progress`` says whether to show a bar meanwhile: of thousands of meshes it takes minutes.

    Raises:
        InputError: if the renderer does not run, or no mesh of a split can be used.
    """
    for _, outcome in pool.run(check_recipe, [recipe]):
        if isinstance(outcome, Killed):
            raise RunError(f"{type(recipe).__name__} kills the process that asks whether it runs.")
    reasons = find_troubles(pool, list(meshes.values()), plural(recipe.noun), progress)
    left_out = {name: reasons[name] for name in meshes if name in reasons}
    splits = {}
    for split, number in views.items():
        usable = tuple(source.name for source in sources[split] if source.name not in left_out)
        if not usable:
            first = left_out[sources[split][0].name]
            raise InputError(
                f"none of the {len(sources[split])} {plural(recipe.noun)} for {split} can be used; "
                f"the first: {first}"
            )
        splits[split] = Layout(usable, number, recipe.size, per_shard, recipe.hints)
    return Manifest(recipe.describe(), splits, left_out)
