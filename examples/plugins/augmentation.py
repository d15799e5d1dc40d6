"""An augmentation, which changes training batches on their device with a seed for each step."""

from dataclasses import dataclass

import torch

from normalgan.batch import Batch
from normalgan.data.augmentation import AUGMENTATIONS, BatchAugmentation
from normalgan.testing import check


@AUGMENTATIONS.register
@dataclass(frozen=True)
class Grain(BatchAugmentation):
    """Adds the grain of paper to the sketches.

    Args:
        strength: darkness of the grain, 0 to 1.
    """

    strength: float = 0.1

    def __call__(self, batch: Batch, seed: int) -> Batch:
        """Return a batch with grain."""
        sketch = batch["sketch"]
        rng = torch.Generator(sketch.device).manual_seed(seed)
        grain = torch.rand(sketch.shape, generator=rng, device=sketch.device) * self.strength
        return {**batch, "sketch": torch.maximum(sketch, grain)}


if __name__ == "__main__":
    check(Grain())
