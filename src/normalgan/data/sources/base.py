"""DataSource: the base of the data sources; SplitSettings: the settings that they may use."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from normalgan.data.recipe import Loadable, SampleRecipe
from normalgan.data.settings import Split
from normalgan.data.sources.pair import PairRecipe
from normalgan.registry import Registry
from normalgan.rendering.samples import Recipe
from normalgan.rendering.variation import Variation

__all__ = ["DATA_SOURCES", "DataSource", "PairSource", "SplitSettings"]


@dataclass(frozen=True)
class SplitSettings(Split):
    """How data are split, as `Split` says, and the other data settings that a source may use.

    Args:
        data_seed: seed of everything random in the data, such as animals.
        variation: how far individuals that join the training meshes differ from them.
    """

    data_seed: int = 0
    variation: Variation = field(default_factory=Variation)


class DataSource(ABC):
    """Base of the data sources, which list what to train, validate and test on.

    A source is a frozen dataclass of plain settings. It returns meshes, which are rendered as
    the settings of the data say, or pairs, if it derives from `PairSource`. Each is loaded once, perhaps in a
    worker process, to see whether it can be used. The samples made of it are kept in the cache.
    """

    @abstractmethod
    def split(self, settings: SplitSettings) -> Mapping[str, Sequence[Loadable]]:
        """Return the items of ``train``, ``val`` and ``test``; each has a unique name.

        Args:
            settings: how to split; ``settings.deal(names)`` does it.

        Raises:
            InputError: if something cannot be used.
        """

    def recipe(self, rendering: Recipe) -> SampleRecipe:
        """Return how samples are made: meshes are rendered as the settings of the data say.

        Args:
            rendering: what they say.
        """
        return rendering

    def views(self, wanted: Mapping[str, int]) -> Mapping[str, int]:
        """Return how many samples are made of each mesh, by split.

        Args:
            wanted: the settings of the data.
        """
        return wanted


class PairSource(DataSource, ABC):
    """Base of the data sources with existing sketches and normal maps; they load a `Pair`.

    Each pair becomes one sample; settings for rendering and drawing are ignored.

    Attributes:
        hints: whether the pairs' own hints are used, in training and testing; otherwise the sampler gives
            them.
    """

    hints: bool = False

    def recipe(self, rendering: Recipe) -> SampleRecipe:
        """Return how samples are made of pairs."""
        return PairRecipe(rendering.size, self.hints)

    def views(self, wanted: Mapping[str, int]) -> Mapping[str, int]:
        """Return 1 for each split."""
        return dict.fromkeys(wanted, 1)


DATA_SOURCES: Registry[DataSource] = Registry(DataSource, "normalgan.data_sources")  # type: ignore[type-abstract]
