"""The versions of packages that the bytes of samples depend on."""

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from normalgan.rendering import samples

__all__ = ["difference", "worker_versions"]

_PACKAGES = ("normalgan", "numpy", "scipy", "scikit-image", "trimesh", "embreex", "zarr", "numcodecs")


@cache
def worker_versions() -> dict[str, str]:
    """Return the versions that must be equal on all machines that render a data set.

    >>> sorted(worker_versions())[:3]
    ['Python', 'embreex', 'normalgan']
    """
    found = {name: _version(name) for name in _PACKAGES}
    found["Python"] = ".".join(platform.python_version_tuple()[:2])
    found["the rendering"] = str(samples.RENDERING_VERSION)
    return found


def difference(theirs: Mapping[str, str], ours: Mapping[str, str]) -> str | None:
    """Return what differs on another machine, or None.

    >>> difference({"numpy": "2.0"}, {"numpy": "2.4", "zarr": "3.1"})
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
