"""DataSource, the base class of data sources, and SplitSettings, the settings that they may use."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.settings import Split
from normalgan.data.sources.pair import PairRecipe
from normalgan.ranges import RangeChecked
from normalgan.registry import Registry
from normalgan.rendering.samples import Recipe
from normalgan.rendering.variation import Variation


@dataclass(frozen=True)
class SplitSettings(Split):
    """Split settings, as in `Split`, and other data settings that a source may use.

    Args:
        data_seed: seed of all randomness in the data, such as animals.
        variation: how much random variants of training meshes differ from them.
    """

    data_seed: int = 0
    variation: Variation = field(default_factory=Variation)


class DataSource(RangeChecked, ABC):
    """Base class of data sources, which list the items for training, validation and testing.

    A source is a frozen dataclass of plain settings. It returns meshes, which are rendered according to
    the data settings, or pairs, if it derives from `PairSource`. Each item is loaded once, possibly in a
    worker process, to check whether it is usable. Its samples are cached.
    """

    @abstractmethod
    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        """Return the items of ``train``, ``val`` and ``test``; each has a unique name.

        Args:
            settings: split settings; ``settings.deal(names)`` splits names accordingly.

        Raises:
            InputError: if the input of the source is invalid.
        """

    def recipe(self, rendering: Recipe) -> SampleRecipe:
        """Return the recipe of the samples; by default, meshes are rendered according to the data settings.

        Args:
            rendering: recipe from the data settings.
        """
        return rendering

    def views(self, wanted: Mapping[str, int]) -> Mapping[str, int]:
        """Return the number of samples per mesh, by split.

        Args:
            wanted: numbers from the data settings.
        """
        return wanted


class PairSource(DataSource, ABC):
    """Base class of data sources with existing sketches and normal maps, which load a `Pair`.

    Each pair becomes one sample. Settings for rendering and drawing are ignored.

    Attributes:
        hints: whether training and testing use the pairs' own hints instead of a sampler's.
    """

    hints: bool = False

    def recipe(self, rendering: Recipe) -> SampleRecipe:
        """Return the recipe for samples of pairs."""
        return PairRecipe(rendering.size, self.hints)

    def views(self, wanted: Mapping[str, int]) -> Mapping[str, int]:
        """Return 1 for each split."""
        return dict.fromkeys(wanted, 1)


DATA_SOURCES: Registry[DataSource] = Registry(DataSource, "normalgan.data_sources")  # type: ignore[type-abstract]
