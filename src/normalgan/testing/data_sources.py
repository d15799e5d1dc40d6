"""Checks of a data source."""

import pickle
from collections import Counter
from collections.abc import Iterator

from normalgan.contracts import class_name
from normalgan.data.recipe import Loadable
from normalgan.data.sources import DataSource, Pair, PairSource, SplitSettings
from normalgan.data.splits import SPLITS
from normalgan.rendering import Mesh
from normalgan.testing.conformance import Check, demand
from normalgan.testing.settings import frozen_check, settings_checks


def data_source_checks() -> list[Check[DataSource]]:
    """Return the named checks of a data source, for ``pytest.mark.parametrize``."""
    return [
        *settings_checks(DataSource),  # type: ignore[type-abstract]
        frozen_check(),
        Check("splits by name", _splits, "split must return the items of train, val and test"),
        Check("unique names", _names, "each item needs a unique name and belongs to one split"),
        Check("the same when called again", _repeats, "names and fingerprints must not change between calls"),
        Check("items for worker processes", _handed, "items must survive pickling"),
        Check("meshes or pairs", _loaded, "load must return a Mesh, or a Pair of a PairSource"),
    ]


def _split(source: DataSource) -> dict[str, list[Loadable]]:
    return {name: list(part) for name, part in source.split(SplitSettings()).items()}


def _firsts(source: DataSource) -> Iterator[Loadable]:
    yield from (part[0] for part in _split(source).values() if part)


def _splits(source: DataSource) -> None:
    found = _split(source)
    strange = sorted(set(found) - set(SPLITS))
    did = f"has a split {strange[0] if strange else ''}"
    demand(not strange, source, did, f"they are {', '.join(SPLITS)}")
    demand(
        found.get("train"),
        source,
        "has nothing to train on",
        "settings.deal(names) assigns names to all splits",
    )


def _names(source: DataSource) -> None:
    counts = Counter(thing.name for part in _split(source).values() for thing in part)
    twice = [name for name, count in counts.items() if count > 1]
    did = f"has two items named {twice[0] if twice else ''}"
    demand(not twice, source, did, "each item needs a unique name and belongs to one split")


def _repeats(source: DataSource) -> None:
    one, other = ([(t.name, t.fingerprint()) for t in _firsts(source)] for _ in range(2))
    demand(
        one == other, source, "has other names or fingerprints when called again", "the cache relies on them"
    )
    prints = [seen for _, seen in one]
    demand(
        len(set(prints)) == len(prints),
        source,
        "has two items with the same fingerprint",
        "fingerprints must distinguish items",
    )


def _handed(source: DataSource) -> None:
    for thing in _firsts(source):
        again = pickle.loads(pickle.dumps(thing))  # pickled by ourselves just now
        same = (again.name, again.fingerprint()) == (thing.name, thing.fingerprint())
        demand(same, source, f"has {thing.name}, which changes when pickled", "workers load the pickled item")


def _loaded(source: DataSource) -> None:
    wanted: type = Pair if isinstance(source, PairSource) else Mesh
    for thing in _firsts(source):
        loaded = thing.load()
        did = f"has {thing.name}, which loads as {class_name(loaded)}"
        demand(isinstance(loaded, wanted), source, did, f"load must return a {wanted.__name__}")
