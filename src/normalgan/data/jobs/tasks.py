"""Tasks for worker processes, which do not import torch, and the loops that run them."""

import socket
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from operator import attrgetter
from pathlib import Path
from typing import Any

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.recipe import Loadable, SampleRecipe, fingerprint
from normalgan.data.store.fsspec_storage import ObjectFolder
from normalgan.data.store.sample_layout import Shard, blank
from normalgan.data.store.shards import ZARR, damaged, write_shard, write_traces
from normalgan.errors import FOREIGN_ERRORS, InputError, RunError, brief, third_party_place
from normalgan.rendering.mesh_bytes import read_once
from normalgan.rendering.samples import Sample


@dataclass(frozen=True)
class MeshTask:
    """A mesh to check, with the fingerprint from the machine that sends the task."""

    source: Loadable
    fingerprint: str

    @property
    def meshes(self) -> tuple[str, ...]:
        """The name of the mesh."""
        return (self.source.name,)


@dataclass(frozen=True)
class ShardTask:
    """A shard to render for the data set at a URL.

    ``sources`` holds its meshes by name, and ``failed`` the reasons not to try some of them.
    """

    url: str
    shard: Shard
    recipe: SampleRecipe
    sources: dict[str, MeshTask]
    failed: dict[str, str] = field(default_factory=dict)

    @property
    def meshes(self) -> tuple[str, ...]:
        """The names of the meshes to try."""
        return tuple(mesh for mesh in self.shard.meshes if mesh not in self.failed)


@dataclass(frozen=True)
class MakeShard:
    """Creates shards in the process that reads them, with a warning for each mesh or pair that fails."""

    url: str
    recipe: SampleRecipe
    sources: Mapping[str, MeshTask]

    def __call__(self, shard: Shard) -> None:
        """Create a shard. Raises the errors of `render_shard`."""
        for name, why in render_shard(self.task(shard)).items():
            warnings.warn(f"the {self.recipe.noun} {name} is left out: {why}", stacklevel=2)

    def task(self, shard: Shard) -> ShardTask:
        """Return the task of a shard."""
        needed = {name: self.sources[name] for name in shard.meshes}
        return ShardTask(self.url, shard, self.recipe, needed)


# Each process caches the last mesh with its name and fingerprint, because its views are rendered in a row.
_last: tuple[tuple[str, str], Any] | None = None


def render_shard(task: ShardTask) -> dict[str, str]:
    """Render and write all samples of a shard, and return the reasons for failed meshes by name.

    If a mesh fails, the other meshes of the shard are still rendered.

    Raises:
        InputError: if this machine cannot run the renderer, cannot write, or cannot read the same store
            and meshes as the machine that sent the task.
    """
    samples, failed, traces = _render(task)
    storage = ObjectFolder(task.url)
    if traces:
        where = write_traces(storage, task.shard, traces)
        failed |= {
            name: f"{failed[name].removesuffix('.')}; the traceback is in the cache, {where}."
            for name in traces
        }
    write_shard(storage, task.shard, samples, failed)
    return failed


def _try_mesh(task: ShardTask) -> None:
    """Render a shard without writing it, to test whether the process survives."""
    _render(task)


def _render(task: ShardTask) -> tuple[list[Sample], dict[str, str], dict[str, str]]:
    """Return the samples, the reasons for failed meshes, and the tracebacks of bugs."""
    _see(task.url, task.shard.split)
    check_recipe(task.recipe)
    failed = dict(task.failed)
    traces: dict[str, str] = {}
    samples = []
    for name, view in task.shard.samples:
        sample = blank(task.shard.size, task.shard.hints)
        if name not in failed:
            try:
                sample = task.recipe.render(_load(task.sources[name]), view)
            except ChangedMeshError:
                raise
            except FOREIGN_ERRORS as error:  # a renderer or style may raise anything
                failed[name] = error_text(error)
                if not isinstance(error, InputError):
                    traces[name] = "".join(traceback.format_exception(error))
        samples.append(sample)
    return samples, failed, traces


def _validate_source(task: MeshTask) -> str | None:
    """Return the reason why a mesh cannot be used, or None if it can.

    Raises:
        ChangedMeshError: if the mesh has changed since the task was created.
    """
    try:
        _load(task)
    except ChangedMeshError:
        raise
    except FOREIGN_ERRORS as error:  # a third-party source may raise anything
        return error_text(error)
    return None


def find_damage(task: tuple[str, str, Sequence[int]]) -> list[int]:
    """Return the damaged shards, given the URL of a data set, a split and shard indices."""
    url, split, numbers = task
    _see(url, split)
    return damaged(ObjectFolder(url), split, numbers)


_checked: set[str] = set()  # recipes that this process can run, cached because the check is slow


def check_recipe(recipe: SampleRecipe) -> None:
    """Raise `InputError` if this machine cannot run the recipe, for example without a working renderer."""
    if repr(recipe) not in _checked:
        recipe.check()
        _checked.add(repr(recipe))


def error_text(error: BaseException) -> str:
    """Return an error as one sentence, with type and line for a bug in a plug-in.

    >>> error_text(InputError("horse has no legs.")), error_text(KeyError("legs"))
    ('horse has no legs.', "KeyError: 'legs'.")
    """
    if isinstance(error, InputError):
        return str(error)
    place = third_party_place(error)
    where = f", in {place.method}, {Path(place.file).name} line {place.line}" if place else ""
    return f"{type(error).__name__}: {brief(error)}{where}."


class ChangedMeshError(InputError):
    """Error for a mesh that has changed since the task was created."""


def _load(task: MeshTask) -> Any:
    """Return the mesh or pair of a task after checking the fingerprint of the loaded bytes.

    Without the check, samples of a replaced file would be stored under the key of the old file.
    """
    global _last  # noqa: PLW0603 -- see above
    key = task.source.name, task.fingerprint
    if _last is None or _last[0] != key:
        with read_once():
            if fingerprint(task.source) != task.fingerprint:
                raise ChangedMeshError(
                    f"{task.source.name} on {socket.gethostname()} has changed since rendering "
                    "began, or is missing; do not change files while rendering, and keep them the same "
                    "on every machine."
                )
            _last = key, task.source.load()
    return _last[1]


@cache
def _see(url: str, split: str) -> None:
    if ObjectFolder(url).size(f"{ZARR}/{split}/zarr.json") is None:
        raise InputError(
            f"{socket.gethostname()} does not see {url}; the cache must be a folder that all machines share, "
            "or a URL."
        )


DEADLY = "it kills the process that renders it, most likely because memory runs out."

_NOBODY = (
    "every mesh kills the workers, most likely because memory runs out; finished samples are "
    "kept: give them more memory, and run again."
)
_HOPELESS = 3  # killing meshes before any task finishes, after which the machine is assumed at fault
_names: Callable[[MeshTask | ShardTask], tuple[str, ...]] = attrgetter("meshes")


def render_shards(pool: Pool, tasks: Sequence[ShardTask]) -> Iterator[tuple[ShardTask, dict[str, str]]]:
    """Yield each task when it finishes, with the reasons for failed meshes.

    A dead worker also loses unrelated tasks, so a killed shard is only a suspect. It waits, together with
    all shards that share a mesh with it, until the others are done. Then its meshes are tried one at a
    time. A mesh that kills its worker is left out, and the others continue.

    Raises:
        RunError: if workers die regardless of the task.
        InputError: if the machines cannot run the tasks; see `render_shard`.
    """
    deadly: dict[str, str] = {}
    finished = 0
    todo = list(tasks)
    while todo:
        suspects = []
        for task, outcome in pool.run(render_shard, [_without(task, deadly) for task in todo], _names):
            if isinstance(outcome, Killed):
                suspects.append(task)
            else:
                finished += 1
                yield task, outcome
        todo = sorted(suspects, key=lambda task: (task.shard.split, task.shard.number))
        if todo:
            name = _killer(pool, todo[0])
            if name is not None:
                deadly[name] = DEADLY
                if len(deadly) >= _HOPELESS and not finished:
                    raise RunError(_NOBODY)
                continue
            task, outcome = todo[0], pool.alone(render_shard, todo.pop(0))  # another task killed its worker
            if isinstance(outcome, Killed):
                raise RunError(_NOBODY)
            yield task, outcome


def validate_sources(pool: Pool, tasks: Sequence[MeshTask]) -> Iterator[tuple[MeshTask, str | None]]:
    """Yield each mesh with the reason why it is unusable, or None. Raises as `_validate_source`."""
    suspects = []
    for task, outcome in pool.run(_validate_source, tasks, _names):
        if isinstance(outcome, Killed):
            suspects.append(task)
        else:
            yield task, outcome
    for task in suspects:
        outcome = pool.alone(_validate_source, task)
        yield task, DEADLY if isinstance(outcome, Killed) else outcome


def _killer(pool: Pool, task: ShardTask) -> str | None:
    """Return the first mesh of a shard that kills a worker on its own."""
    for name in task.meshes:
        others = {mesh: "" for mesh in task.meshes if mesh != name}
        if isinstance(pool.alone(_try_mesh, _without(task, others)), Killed):
            return name
    return None


def _without(task: ShardTask, deadly: dict[str, str]) -> ShardTask:
    known = {mesh: why for mesh, why in deadly.items() if mesh in task.shard.meshes}
    return replace(task, failed={**task.failed, **known}) if known else task
