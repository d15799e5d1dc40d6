"""The worker's side of a cluster: check versions, then run a task."""

import contextlib
import pickle
import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from normalgan.errors import InputError, brief
from normalgan.rendering import samples

_DO = "__import__('normalgan.data.jobs.cluster_worker', fromlist=['perform']).perform(work, ours, folder)"
_ASK = "__import__('normalgan.data.jobs.cluster_worker', fromlist=['perform']).worker_versions()"
_PACKAGES = ("normalgan", "numpy", "scipy", "scikit-image", "trimesh", "embreex", "zarr", "numcodecs")
"""Packages whose versions affect the bytes of samples."""


@dataclass(frozen=True)
class Unfit:
    """The answer of a worker that refuses a task because its result would differ."""

    worker: str


def order(function: Callable[[Any], Any], task: object) -> tuple[str, dict[str, Any]]:
    """Return the arguments for `eval` to call `perform` in a worker.

    Nothing of normalgan is unpickled before the versions are checked. A worker without normalgan must fail
    within the task, because Dask considers a worker dead if unpickling the function fails.
    """
    work = pickle.dumps((function, task), protocol=5)
    return _DO, {"work": work, "ours": worker_versions(), "folder": str(Path.cwd())}


def perform(work: bytes, ours: Mapping[str, str], folder: str) -> Any:
    """Run a task in a worker and return its result.

    Args:
        work: pickled function and task.
        ours: versions on the machine that sends the task.
        folder: working directory of that machine, used for relative paths if the worker has such a folder.

    Raises:
        InputError: as raised by the task, with the worker's address added.
    """
    from distributed import get_worker

    address = get_worker().address
    if _difference(worker_versions(), ours):
        return Unfit(address)
    function, task = pickle.loads(work)
    with contextlib.chdir(folder) if Path(folder).is_dir() else contextlib.nullcontext():
        try:
            return function(task)
        except InputError as error:
            raise type(error)(f"{str(error).removesuffix('.')} (worker {address}).") from error


def flaws(client: Any, threads: Mapping[str, int]) -> dict[str, str]:
    """Return the reasons why workers are unfit, by address.

    Args:
        client: client of the cluster.
        threads: number of threads of each worker to check, by address.
    """
    # `eval`, because a worker without normalgan cannot unpickle its functions.
    responses = client.run(eval, _ASK, workers=list(threads), on_error="return") if threads else {}
    found = {}
    for address, response in responses.items():
        if isinstance(response, OSError):
            continue  # already gone
        if isinstance(response, ImportError):
            found[address] = "no normalgan, or an older one"
        elif isinstance(response, Exception):
            found[address] = f"a fault ({brief(response)})"
        elif threads[address] != 1:
            found[address] = f"{threads[address]} threads, not 1: a renderer belongs to one (--nthreads 1)"
        elif other := _difference(response, worker_versions()):
            found[address] = other
    return found


@cache
def worker_versions() -> dict[str, str]:
    """Return the versions that must be the same on all machines that render a data set.

    >>> sorted(worker_versions())[:3]
    ['Python', 'embreex', 'normalgan']
    """
    found = {name: _version(name) for name in _PACKAGES}
    found["Python"] = ".".join(platform.python_version_tuple()[:2])
    found["the rendering"] = str(samples.RENDERING_VERSION)
    return found


def _difference(theirs: Mapping[str, str], ours: Mapping[str, str]) -> str | None:
    """Return how another machine's versions differ, or None if they are the same.

    >>> _difference({"numpy": "2.0"}, {"numpy": "2.4", "zarr": "3.1"})
    'numpy 2.0, not 2.4; no zarr, not 3.1'
    """
    other = [
        f"{f'{name} {theirs[name]}' if name in theirs else f'no {name}'}, not {ours[name]}"
        for name in ours
        if theirs.get(name) != ours[name]
    ]
    return "; ".join(other) or None


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"
