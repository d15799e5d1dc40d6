"""Find unusable meshes before training, so that a bad one fails alone and at once."""

import hashlib
import json
from collections.abc import Mapping, Sequence

from normalgan.data.jobs.shard_runner import validate_sources
from normalgan.data.jobs.tasks import MeshTask
from normalgan.data.jobs.workers import Workers
from normalgan.data.recipe import Loadable
from normalgan.data.store.manifest import fingerprints
from normalgan.data.store.storage import Storage
from normalgan.errors import InputError
from normalgan.progress import progress_bar
from normalgan.rendering.samples import RENDERING_VERSION

__all__ = ["find_unusable", "leave_out"]


def find_unusable(cache: str, sources: Sequence[Loadable], workers: int = 0) -> dict[str, str]:
    """Return the reasons why meshes cannot be used, by name.

    This needs loading, up to a second a mesh, so the result is cached as ``meshes/<key>.json`` under a hash
    of the fingerprints, for resumed runs and for all training processes.

    Args:
        cache: folder or URL of all data sets.
        sources: the meshes.
        workers: processes to load in, 0 for this one alone.

    Raises:
        InputError: if the cache cannot be written to, or a worker is killed.
    """
    prints = fingerprints({"": sources})[""]
    key = hashlib.sha256(json.dumps([RENDERING_VERSION, prints]).encode())
    path = f"{key.hexdigest()[:24]}.json"
    folder = Storage(cache) / "meshes"
    try:
        return dict(json.loads(folder.read(path) or b"")["left_out"])
    except (ValueError, TypeError, KeyError):  # not asked yet, or damaged
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
    folder.write(path, (json.dumps({"left_out": left_out}, indent=1) + "\n").encode())
    return left_out


def leave_out(sources: Sequence[Loadable], reasons: Mapping[str, str], split: str) -> list[Loadable]:
    """Return the meshes that can be used.

    Args:
        sources: the meshes.
        reasons: why some of them cannot be used, by name.
        split: name of their split.

    Raises:
        InputError: if none is left.
    """
    usable = [source for source in sources if source.name not in reasons]
    if not usable:
        first = reasons[sources[0].name] if sources else "there is none."
        raise InputError(f"none of the {len(sources)} meshes for {split} can be used; the first: {first}")
    return usable
