"""Learning-rate schedules that fit the length of a run."""

import math

from torch.optim.lr_scheduler import CosineAnnealingLR

__all__ = ["end_cosine_at"]


def end_cosine_at(schedule: CosineAnnealingLR, epochs: int) -> None:
    """Give a cosine schedule another length, and its optimiser the rate of the present epoch.

    PyTorch derives each rate from the one before. A schedule that has reached 0 would stay there.

    Args:
        schedule: stepped once an epoch; nothing happens if it has this length.
        epochs: after how many the rate is the lowest.
    """
    if schedule.T_max == epochs:
        return
    schedule.T_max = epochs
    share = (1 + math.cos(math.pi * schedule.last_epoch / epochs)) / 2
    for group, rate in zip(schedule.optimizer.param_groups, schedule.base_lrs, strict=True):
        group["lr"] = schedule.eta_min + (rate - schedule.eta_min) * share
