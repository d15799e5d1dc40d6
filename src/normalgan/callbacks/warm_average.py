"""An average of the weights over the last steps, which is measured and saved in their place."""

import torch
from lightning.pytorch.callbacks import WeightAveraging
from torch import Tensor

from normalgan.errors import InputError


class WarmAverage(WeightAveraging):
    """Measures and saves an exponential moving average of the weights in their place.

    An average that is slow from the first step on keeps the untrained weights in it for hundreds of steps,
    which is worse than none in a short run. This one forgets fast at first: after n steps the former average
    counts ``min(decay, (1 + n) / (10 + n))``, so that it reaches over about the last ninth of the run until
    ``decay`` holds it (the schedule of TensorFlow's ``ExponentialMovingAverage`` with ``num_updates``).

    Args:
        decay: share that the former average keeps at a step in the end, in [0, 1).

    Raises:
        InputError: if the decay is not in [0, 1).
    """

    def __init__(self, decay: float = 0.998) -> None:
        if not 0 <= decay < 1:
            raise InputError(f"WarmAverage was given decay={decay}; use a share from 0 to below 1.")
        self.decay = decay
        super().__init__(avg_fn=self._mix)

    def _mix(self, average: Tensor, weights: Tensor, steps: Tensor | int) -> Tensor:
        if not weights.is_floating_point():  # such as a count of batches
            return weights
        number = int(steps)
        share = min(self.decay, (1 + number) / (10 + number))
        return torch.lerp(weights, average, share)

    def should_update(self, step_idx: int | None = None, epoch_idx: int | None = None) -> bool:
        """Return whether the average takes the weights in: after each step."""
        return step_idx is not None
