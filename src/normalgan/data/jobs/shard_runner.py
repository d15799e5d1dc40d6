"""Render shards until all are done; a mesh that kills its worker is found and left out."""

import dataclasses
from collections.abc import Iterator, Sequence

from normalgan.data.jobs.pool import Killed, Pool
from normalgan.data.jobs.tasks import MeshTask, ShardTask, render_shard, try_mesh, validate_source
from normalgan.errors import RunError

__all__ = ["DEADLY", "render_shards", "validate_sources"]

DEADLY = "it kills the process that renders it, most likely because memory runs out."

_NOBODY = (
    "every mesh kills the workers, most likely because memory runs out; finished samples are "
    "kept: give them more, and run again."
)
_HOPELESS = 3  # deadly meshes before anything is finished, after which the meshes are not to blame


def render_shards(pool: Pool, tasks: Sequence[ShardTask]) -> Iterator[tuple[ShardTask, dict[str, str]]]:
    """Yield every task when it finishes, with the meshes that failed.

    A dead worker also loses other tasks, so a killed shard is only a suspect. It and the shards that share a
    mesh with it wait until all others are done. Then its meshes are tried one at a time: the one that kills
    its worker is left out, and the others continue.

    Raises:
        RunError: if workers die with any task.
        InputError: if the machines cannot do the work; see `render_shard`.
    """
    deadly: dict[str, str] = {}
    finished = 0
    todo = list(tasks)
    while todo:
        suspects = []
        for task, outcome in pool.run(render_shard, [_without(task, deadly) for task in todo], _meshes):
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
    """Yield every mesh and why it cannot be used, None if it can. Raises as `validate_source` does."""
    suspects = []
    for task, outcome in pool.run(validate_source, tasks, _meshes):
        if isinstance(outcome, Killed):
            suspects.append(task)
        else:
            yield task, outcome
    for task in suspects:
        outcome = pool.alone(validate_source, task)
        yield task, DEADLY if isinstance(outcome, Killed) else outcome


def _killer(pool: Pool, task: ShardTask) -> str | None:
    """Return the first mesh of a shard that kills a worker on its own."""
    for name in task.meshes:
        others = {mesh: "" for mesh in task.meshes if mesh != name}
        if isinstance(pool.alone(try_mesh, _without(task, others)), Killed):
            return name
    return None


def _meshes(task: ShardTask | MeshTask) -> tuple[str, ...]:
    return task.meshes


def _without(task: ShardTask, deadly: dict[str, str]) -> ShardTask:
    known = {mesh: why for mesh, why in deadly.items() if mesh in task.shard.meshes}
    return dataclasses.replace(task, failed={**task.failed, **known}) if known else task
