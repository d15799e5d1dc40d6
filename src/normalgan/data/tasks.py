"""Tasks: what a worker process is asked to do; it loads neither torch nor anything that needs it."""

from dataclasses import dataclass

from normalgan.data.shards import ShardedSamples
from normalgan.errors import InputError
from normalgan.rendering.mesh import Mesh, MeshSource
from normalgan.rendering.renderers.base import Renderer
from normalgan.rendering.samples import Recipe


@dataclass(frozen=True)
class ShardTask:
    """A shard to be rendered, and all that it takes.

    Args:
        store: where it goes.
        number: which shard it is.
        recipe: how samples are made.
        meshes: the meshes it has views of and their fingerprints, by name.
    """

    store: ShardedSamples
    number: int
    recipe: Recipe
    meshes: dict[str, tuple[MeshSource, str]]


# The mesh used last, with its name and fingerprint: the views of one follow one another. It belongs to the
# process.
_last: tuple[tuple[str, str], Mesh] | None = None


def render_shard(task: ShardTask) -> None:
    """Render all samples of a shard and write them."""
    samples = []
    for index in task.store.layout.indices(task.number):
        name, view = task.store.mesh_and_view(index)
        samples.append(task.recipe.render(_load(*task.meshes[name]), view))
    task.store.write(task.number, samples)


def _load(source: MeshSource, fingerprint: str) -> Mesh:
    global _last  # noqa: PLW0603 -- see above
    if _last is None or _last[0] != (source.name, fingerprint):
        _last = (source.name, fingerprint), source.load()
    return _last[1]


def find_trouble(source: MeshSource) -> str | None:
    """Return why a mesh cannot be used, or None if it can."""
    try:
        source.load()
    except InputError as error:
        return str(error)
    return None


def check_renderer(renderer: Renderer) -> None:
    """Raise `InputError` if the renderer does not run here."""
    renderer.check()
