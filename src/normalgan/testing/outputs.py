"""Checks of an output."""

import numpy as np

from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs import Output
from normalgan.testing.conformance import Check, demand
from normalgan.testing.settings import frozen_check, settings_checks

_SIZE = 48


def output_checks() -> list[Check[Output]]:
    """Return the named checks of an output, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(Output),  # type: ignore[type-abstract]
        frozen_check(),
        Check("settings with defaults", _by_default, "it must be constructible without arguments"),
        Check("files with its endings", _endings, "encode must return bytes for each entry of endings"),
        Check("the same bytes for the same map", _repeatable, "the output may depend on nothing else"),
        Check("a map without an object", _empty, "such a map must give files or an InputError"),
        Check("an unchanged map", _untouched, "the map belongs to the caller"),
    ]


def _ball(radius: float = 16.0) -> NormalMap:
    along = np.arange(_SIZE, dtype=np.float32) - _SIZE / 2 + 0.5
    x, y = np.meshgrid(along / max(radius, 1), -along / max(radius, 1))
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    mask = (z > 0) & (radius > 0)
    normals = np.where(mask[..., None], np.dstack([x, y, z]), np.array([0, 0, 1], np.float32)).astype(
        np.float32
    )
    return NormalMap(normals, mask, mask.astype(np.float32))


def _by_default(output: Output) -> None:
    demand(type(output)().endings, output, "has no endings by default", "each file needs an ending")


def _endings(output: Output) -> None:
    files = output.encode(_ball())
    did = f"returned files that end in {', '.join(files)}, but its endings are {', '.join(output.endings)}"
    demand(tuple(files) == output.endings, output, did, "both must be the same, in the same order")
    plain = all(ending.startswith("_") and "." in ending and "/" not in ending for ending in files)
    demand(plain, output, f"has the endings {', '.join(files)}", "endings look like _height.png")
    other = [ending for ending, content in files.items() if not isinstance(content, bytes) or not content]
    demand(not other, output, f"returned no bytes for {', '.join(other)}", "a file must have content")


def _repeatable(output: Output) -> None:
    demand(
        output.encode(_ball()) == output.encode(_ball()),
        output,
        "returned different bytes for the same map",
        "files must be reproducible",
    )


def _empty(output: Output) -> None:
    try:
        output.encode(_ball(0))
    except InputError:
        return


def _untouched(output: Output) -> None:
    given, kept = _ball(), _ball()
    output.encode(given)
    same = np.array_equal(given.extended, kept.extended) and np.array_equal(given.mask, kept.mask)
    demand(same, output, "changed the map that it was given", "copy it")
