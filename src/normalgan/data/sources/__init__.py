"""Data sources: meshes, embedded animals, pairs on disk; no torch."""

from normalgan.data.sources.base import DATA_SOURCES, DataSource, PairSource, SplitSettings
from normalgan.data.sources.meshes import Animals, MeshGroup
from normalgan.data.sources.pair import Pair
from normalgan.data.sources.pairs import Pairs

__all__ = [
    "DATA_SOURCES",
    "Animals",
    "DataSource",
    "MeshGroup",
    "Pair",
    "PairSource",
    "Pairs",
    "SplitSettings",
]
