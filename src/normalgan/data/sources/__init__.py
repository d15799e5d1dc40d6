"""Data sources: groups of meshes, pairs on disk, and their base class; does not need torch."""

from normalgan.data.sources.base import DATA_SOURCES, DataSource, PairSource, SplitSettings
from normalgan.data.sources.meshes import MeshGroup
from normalgan.data.sources.pair import Pair
from normalgan.data.sources.pairs import Pairs
from normalgan.registry import import_modules

import_modules(__name__)

__all__ = ["DATA_SOURCES", "DataSource", "MeshGroup", "Pair", "PairSource", "Pairs", "SplitSettings"]
